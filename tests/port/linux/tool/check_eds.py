# Holds an EDS against what CiA 306 asks for, and the DBC, as canmatrix reads it, against the EDS's mappings:
# check_eds.py FLATPOSE. The checks are tried on broken copies too, so that they are known to find something.
import configparser
import re
import struct
import subprocess
import sys
import tempfile
import unittest

import canmatrix.formats

FLATPOSE = sys.argv.pop(1)
FILE_KEYS = {"FileName", "FileVersion", "FileRevision", "EDSVersion", "Description", "CreationTime", "CreationDate",
             "CreatedBy", "ModificationTime", "ModificationDate", "ModifiedBy"}
DEVICE_KEYS = {"VendorName", "VendorNumber", "ProductName", "ProductNumber", "RevisionNumber", "OrderCode",
               "BaudRate_10", "BaudRate_20", "BaudRate_50", "BaudRate_125", "BaudRate_250", "BaudRate_500",
               "BaudRate_800", "BaudRate_1000", "SimpleBootUpMaster", "SimpleBootUpSlave", "Granularity",
               "DynamicChannelsSupported", "GroupMessaging", "NrOfRXPDO", "NrOfTXPDO", "LSS_Supported"}
VARIABLE_KEYS = {"ParameterName", "DataType", "AccessType", "DefaultValue", "PDOMapping"}
LISTS = ("MandatoryObjects", "OptionalObjects", "ManufacturerObjects")
BITS = {2: 8, 3: 16, 4: 32, 5: 8, 6: 16, 7: 32, 8: 32, 9: 0, 10: 0, 0x10: 24}
ACCESS = {"ro", "wo", "rw", "rwr", "rww", "const"}


def printed(form, *more):
    return subprocess.run([FLATPOSE, "map", "--format", form, *more], check=True, capture_output=True, text=True).stdout


def read(text):
    eds = configparser.ConfigParser(interpolation=None, delimiters=("=",), strict=True)
    eds.optionxform = str
    eds.read_string(text)
    return eds


def check_variable(eds, name):
    section = eds[name]
    missing = VARIABLE_KEYS - set(section)
    assert not missing, f"{name} lacks {missing}"
    kind = int(section["DataType"], 16)
    assert kind in BITS, f"{name} has data type {kind}"
    assert section["AccessType"] in ACCESS, name
    assert len(section["ParameterName"]) <= 241, name
    value = section["DefaultValue"].replace("$NODEID+", "")
    if BITS[kind] and value:
        assert 0 <= int(value, 16) < 1 << BITS[kind], f"{name}: {value} does not fit"
    assert section["PDOMapping"] in ("0", "1"), name
    return BITS[kind]


def check(text):
    """The PDO mappings, by index; AssertionError, KeyError or configparser's own where something is wrong."""
    eds = read(text)
    assert FILE_KEYS <= set(eds["FileInfo"]), FILE_KEYS - set(eds["FileInfo"])
    assert DEVICE_KEYS <= set(eds["DeviceInfo"]), DEVICE_KEYS - set(eds["DeviceInfo"])
    assert {f"Dummy{i:04X}" for i in range(1, 8)} <= set(eds["DummyUsage"])
    comments = eds["Comments"]
    assert {f"Line{i + 1}" for i in range(int(comments["Lines"]))} == set(comments) - {"Lines"}
    wanted = {"FileInfo", "DeviceInfo", "DummyUsage", "Comments", *LISTS}
    listed = []
    for name in LISTS:
        count = int(eds[name]["SupportedObjects"])
        assert set(eds[name]) == {"SupportedObjects"} | {str(i + 1) for i in range(count)}, name
        listed += [int(eds[name][str(i + 1)], 16) for i in range(count)]
    assert len(set(listed)) == len(listed), "an object is listed twice"
    assert {0x1000, 0x1001, 0x1018} == {int(eds["MandatoryObjects"][str(i)], 16) for i in (1, 2, 3)}
    for index in listed:
        name = f"{index:04X}"
        wanted.add(name)
        if int(eds[name]["ObjectType"], 16) == 7:
            check_variable(eds, name)
            continue
        subs = [s for s in eds.sections() if re.fullmatch(f"{name}sub[0-9A-F]+", s)]
        wanted |= set(subs)
        assert len(subs) == int(eds[name]["SubNumber"], 16), f"{name} has {len(subs)} subs"
        for sub in subs:
            check_variable(eds, sub)
        highest = max(int(s.split("sub")[1], 16) for s in subs)
        if index != 0x1003:  # there it counts what happened
            assert int(eds[name + "sub0"]["DefaultValue"], 16) == highest, f"{name}sub0"
    assert set(eds.sections()) == wanted, set(eds.sections()) ^ wanted
    device = eds["DeviceInfo"]
    assert int(device["NrOfRXPDO"]) == sum(0x1400 <= i < 0x1600 for i in listed)
    assert int(device["NrOfTXPDO"]) == sum(0x1800 <= i < 0x1A00 for i in listed)
    assert int(device["ProductNumber"], 16) == int(eds["1018sub2"]["DefaultValue"], 16)
    assert int(device["RevisionNumber"], 16) == int(eds["1018sub3"]["DefaultValue"], 16)
    return {i: mapping(eds, i) for i in listed if 0x1600 <= i < 0x1800 or 0x1A00 <= i < 0x1C00}


def mapping(eds, index):
    """[(name, bits)] of a PDO that is full and made of objects that may be mapped in its direction."""
    found = []
    for i in range(1, int(eds[f"{index:04X}sub0"]["DefaultValue"], 16) + 1):
        value = int(eds[f"{index:04X}sub{i:X}"]["DefaultValue"], 16)
        sub = f"{value >> 16:04X}sub{value >> 8 & 0xFF:X}"
        assert eds[sub]["PDOMapping"] == "1", f"{sub} is mapped"
        assert eds[sub]["AccessType"] == ("rww" if index < 0x1800 else "ro"), sub
        assert BITS[int(eds[sub]["DataType"], 16)] == value & 0xFF, sub
        found.append((eds[sub]["ParameterName"], value & 0xFF))
    assert sum(bits for _, bits in found) == 64
    return found


class Eds(unittest.TestCase):
    def test_has_what_cia_306_asks_for(self):
        self.assertEqual(set(check(printed("eds"))), {0x1600, 0x1A00, 0x1A01, 0x1A02, 0x1A03})

    def test_has_the_fd_frame_switched_off(self):
        eds = read(printed("eds"))
        self.assertEqual(eds["2006sub1"]["DefaultValue"], "$NODEID+0xC0000500")
        for sub in "235":
            self.assertEqual(dict(eds[f"2006sub{sub}"]), dict(eds[f"1800sub{sub}"]))

    def test_broken_copies_are_found_out(self):
        text = printed("eds")
        for old, new in (("SupportedObjects=3", "SupportedObjects=4"), ("\n[1018sub4]", "\n[1018sub5]"),
                         ("DataType=0x0010", "DataType=0x0004"), ("PDOMapping=1", "PDOMapping=0"),
                         ("AccessType=rww", "AccessType=rw"), ("Granularity=0\n", ""), ("NrOfTXPDO=4", "NrOfTXPDO=3"),
                         ("SubNumber=0x5", "SubNumber=0x4"), ("0x20030718", "0x20030710")):
            self.assertIn(old, text)
            with self.assertRaises((AssertionError, KeyError, configparser.Error), msg=f"{old} -> {new}"):
                check(text.replace(old, new, 1))


class Dbc(unittest.TestCase):
    def frames(self, node):
        with tempfile.NamedTemporaryFile("w", suffix=".dbc") as file:
            file.write(printed("dbc", "--node", str(node)))
            file.flush()
            (matrix,) = canmatrix.formats.loadp(file.name).values()
        return matrix

    def test_has_the_frames_of_the_eds(self):
        mappings = check(printed("eds"))
        for node in (1, 10, 127):
            matrix = self.frames(node)
            for index, base in ((0x1600, 0x200), (0x1A00, 0x180), (0x1A01, 0x280), (0x1A02, 0x380), (0x1A03, 0x480)):
                frame = matrix.frame_by_id(canmatrix.ArbitrationId(base + node, extended=False))
                self.assertEqual(frame.size, 8)
                signals = sorted(frame.signals, key=lambda s: s.get_startbit(bit_numbering=1))
                at = 0
                for name, bits in mappings[index]:
                    parts = [s for s in signals if at <= s.get_startbit(bit_numbering=1) < at + bits]
                    self.assertEqual(sum(s.size for s in parts), bits, f"{name} in {frame.name}")
                    if len(parts) == 1:
                        self.assertTrue(parts[0].name.startswith(name), f"{name} is {parts[0].name}")
                    at += bits

    def test_has_the_whole_result_as_an_fd_frame_and_no_other(self):
        for node in (1, 10, 127):
            matrix = self.frames(node)
            frame = matrix.frame_by_id(canmatrix.ArbitrationId(0x500 + node, extended=False))
            self.assertEqual((frame.name, frame.size, frame.is_fd), ("FLATPOSE_RESULT", 64, True))
            self.assertEqual([f.name for f in matrix.frames if f.is_fd], ["FLATPOSE_RESULT"])
            at = 0
            for signal in sorted(frame.signals, key=lambda s: s.get_startbit(bit_numbering=1)):
                self.assertEqual(signal.get_startbit(bit_numbering=1), at, signal.name)
                at += signal.size
            self.assertEqual(at, 512)

    def test_of_the_whole_result_is_decoded_to_values(self):
        frame = self.frames(10).frame_by_id(canmatrix.ArbitrationId(0x50A, extended=False))
        data = struct.pack("<BbBBHH3i4i6HhhI4BHBB", 7, 1, 0x18, 0, 11, 11, -9000123, 2, 3, 400, 500, 600, -700,
                           100, 200, 300, 400, 500, 65534, 9000, -5, 1234567, 1, 254, 2, 3, 0xBEEF, 3, 2)
        values = frame.decode(data)
        phys = {name: float(signal.phys_value) for name, signal in values.items()}
        for name, value in (("position_x", -9000.123), ("rotation_4", -0.7), ("sigma_turn_z", 6.5534),
                            ("score", 0.9), ("visible", -0.0005), ("age_ms", 1234567), ("tool", 254),
                            ("match_index", 3), ("session_id", 0xBEEF), ("sequence", 7), ("done_number", 11)):
            self.assertAlmostEqual(phys[name], value, msg=name)
        self.assertEqual(str(values["convention"].named_value), "abb_quaternion")
        self.assertEqual(str(values["frame"].named_value), "robot")
        self.assertEqual([phys["bit_valid"], phys["bit_ready"]], [1, 0])

    def test_is_decoded_to_values(self):
        frame = self.frames(10).frame_by_id(canmatrix.ArbitrationId(0x28A, extended=False))
        x, y = -123456, 7654321
        data = bytes([7]) + x.to_bytes(3, "little", signed=True) + y.to_bytes(3, "little", signed=True) + bytes([180])
        values = {name: float(signal.phys_value) for name, signal in frame.decode(data).items()}
        self.assertAlmostEqual(values["position_x"], -123.456)
        self.assertAlmostEqual(values["position_y"], 7654.321)
        self.assertAlmostEqual(values["score"], 0.9)
        status = self.frames(10).frame_by_id(canmatrix.ArbitrationId(0x18A, extended=False)).decode(
            bytes([7, 0xEE, 0x16, 0, 1, 2, 3, 4]))
        self.assertEqual(str(status["status"].named_value), "out_of_range")
        self.assertEqual([status[n].raw_value for n in ("bit_ready", "bit_ack", "bit_busy", "bit_valid")], [0, 1, 1, 1])
        self.assertEqual(status["done_number"].raw_value, 0x0403)


if __name__ == "__main__":
    unittest.main()
