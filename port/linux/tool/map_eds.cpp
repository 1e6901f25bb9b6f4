// The electronic data sheet, section by section.

#include <vector>

#include "flatpose/can/config.hpp"
#include "flatpose/can/dictionary.hpp"
#include "flatpose/result_map/table.hpp"
#include "port/linux/files/input_error.hpp"
#include "port/linux/tool/map_can.hpp"
#include "port/linux/tool/number_text.hpp"

namespace flatpose::tool {
namespace {

using can::Access;
using can::Object;
using can::ObjectCode;

std::vector<Object> objects_of(std::uint16_t index) {
  std::vector<Object> objects;
  for (int sub = 0; sub < 255; ++sub) {
    Object object;
    if (can::find_object(index, static_cast<std::uint8_t>(sub), object) == can::Abort::kNone)
      objects.push_back(object);
  }
  return objects;
}

const char* access_of(const Object& object) {
  if (object.access == Access::kConst) return "const";
  if (object.access == Access::kReadOnly) return "ro";
  return object.mapping == can::Mapping::kRpdo ? "rww" : "rw";
}

const char* text_of(const Object& object) {
  const can::Config config;
  switch (object.index) {
    case 0x1008: return config.name;
    case 0x1009: return config.hardware;
    case 0x100a: return FLATPOSE_VERSION;
    default: return "";
  }
}

std::string default_of(const Object& object) {
  if (can::bytes_of(object.type) == 0) return text_of(object);
  return (object.adds_node ? "$NODEID+" : "") + formatted("0x%X", object.initial);
}

std::string variable(const Object& object) {
  return formatted(
      "ParameterName=%s\nObjectType=0x7\nDataType=0x%04X\nAccessType=%s\nDefaultValue=%s\n"
      "PDOMapping=%d\n",
      object.name, static_cast<unsigned>(object.type), access_of(object),
      default_of(object).c_str(), object.mapping == can::Mapping::kNone ? 0 : 1);
}

std::string section(const can::Group& group) {
  const std::vector<Object> objects = objects_of(group.index);
  if (group.code == ObjectCode::kVariable)
    return formatted("\n[%04X]\n", group.index) + variable(objects.at(0));
  std::string text =
      formatted("\n[%04X]\nParameterName=%s\nObjectType=0x%X\nSubNumber=0x%zX\n", group.index,
                group.name, static_cast<unsigned>(group.code), objects.size());
  for (const Object& object : objects)
    text += formatted("\n[%04Xsub%X]\n", group.index, object.subindex) + variable(object);
  return text;
}

bool is_mandatory(std::uint16_t index) {
  return index == 0x1000 || index == 0x1001 || index == 0x1018;
}
bool is_optional(std::uint16_t index) { return index < 0x2000 && !is_mandatory(index); }
bool is_ours(std::uint16_t index) { return index >= 0x2000; }

std::string list(const char* name, bool (*belongs)(std::uint16_t)) {
  std::string lines;
  int count = 0;
  for (int i = 0; i < can::group_count(); ++i) {
    const std::uint16_t index = can::group_at(i).index;
    if (belongs(index)) lines += formatted("%d=0x%04X\n", ++count, index);
  }
  std::string text = formatted("\n[%s]\nSupportedObjects=%d\n", name, count) + lines;
  for (int i = 0; i < can::group_count(); ++i) {
    if (belongs(can::group_at(i).index)) text += section(can::group_at(i));
  }
  return text;
}

std::string head() {
  Object product;
  Object revision;
  (void)can::find_object(0x1018, 2, product);
  (void)can::find_object(0x1018, 3, revision);
  std::string text =
      "[FileInfo]\nFileName=flatpose.eds\n" +
      formatted("FileVersion=%d\nFileRevision=0\nEDSVersion=4.0\n", result_map::kMapVersion) +
      "Description=Pose of flat parts for robots and controllers\n"
      "CreationTime=12:00AM\nCreationDate=11-23-2026\nCreatedBy=flatpose map\n"
      "ModificationTime=12:00AM\nModificationDate=11-23-2026\nModifiedBy=flatpose map\n"
      "\n[DeviceInfo]\nVendorName=flatpose\nVendorNumber=0x0\nProductName=flatpose\n" +
      formatted("ProductNumber=0x%X\n", product.initial) +
      formatted("RevisionNumber=0x%X\nOrderCode=flatpose\n", revision.initial);
  for (const int kbit_per_s : {10, 20, 50, 125, 250, 500, 800, 1000})
    text += formatted("BaudRate_%d=1\n", kbit_per_s);
  text +=
      "SimpleBootUpMaster=0\nSimpleBootUpSlave=1\nGranularity=0\nDynamicChannelsSupported=0\n"
      "CompactPDO=0\nGroupMessaging=0\n" +
      formatted("NrOfRXPDO=1\nNrOfTXPDO=%d\nLSS_Supported=0\n\n[DummyUsage]\n", can::kTpdoCount);
  for (int type = 1; type <= 7; ++type) text += formatted("Dummy%04X=0\n", type);
  return text +
         "\n[Comments]\nLines=4\n"
         "Line1=Made by flatpose map --format eds. No vendor-ID of CiA is assigned: it is 0.\n"
         "Line2=The bit rate is the system's; mappings are fixed; COB-IDs can be switched off.\n"
         "Line3=Scales: 0.001 mm; 0.001 degree; 1e-6 for rotation vector and quaternion.\n"
         "Line4=What each object means stands in docs/registers.md and docs/can.md.\n";
}

}  // namespace

std::string map_eds(const ServedMap& served) {
  if (!served.config_path.empty())
    throw port::InputError("--config", "an EDS holds for every node and every config",
                           "leave it out: what the config sets differs from the EDS's defaults");
  return head() + list("MandatoryObjects", is_mandatory) + list("OptionalObjects", is_optional) +
         list("ManufacturerObjects", is_ours);
}

}  // namespace flatpose::tool
