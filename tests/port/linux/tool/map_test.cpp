// flatpose map: every form is the table's, and the copies in the tree are the tool's.

#include <fstream>
#include <set>

#include "flatpose/result_map/table.hpp"
#include "port/linux/tool/map_text.hpp"
#include "tests/port/linux/tool/workbench.hpp"

extern "C" int flatpose_registers_in_c(int which);

namespace flatpose::tool {
namespace {

std::string file_in_tree(const std::string& name) {
  std::ifstream file(std::string(FLATPOSE_SOURCE_DIR) + "/docs/" + name);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(MapCommand, CopiesInTheTreeAreWhatItPrints) {
  struct Copy {
    const char* format;
    const char* file;
  };
  for (const Copy& copy :
       {Copy{"markdown", "registers.md"}, Copy{"st", "plc/FB_Flatpose.st"},
        Copy{"scl", "plc/FB_Flatpose.scl"}, Copy{"c", "plc/flatpose_registers.h"},
        Copy{"eds", "can/flatpose.eds"}, Copy{"dbc", "can/flatpose.dbc"}}) {
    const Ran ran = run({"map", "--format", copy.format});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(ran.out, file_in_tree(copy.file))
        << "flatpose map --format " << copy.format << " > docs/" << copy.file;
  }
}

TEST(MapCommand, JsonIsTheTable) {
  const json list = json::parse(run({"map", "--format", "json"}).out);
  ASSERT_EQ(list.size(), result_map::entries().size());
  std::set<std::string> names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const result_map::Entry& entry = result_map::entries()[i];
    EXPECT_TRUE(names.insert(list[i].at("name")).second) << list[i].at("name");
    EXPECT_EQ(list[i].at("address"), entry.address);
    EXPECT_EQ(list[i].at("words"), entry.words());
    EXPECT_EQ(list[i].at("scale"), entry.scale);
    EXPECT_EQ(list[i].at("table"),
              entry.table == result_map::Table::kHolding ? "holding" : "input");
    EXPECT_EQ(list[i].at("can").at("index"), entry.can_index);
    EXPECT_TRUE(list[i].at("can").at("subindex").is_number());
    for (const char* key : {"type", "unit", "values", "doc"}) EXPECT_TRUE(list[i].contains(key));
    if (list[i].at("name") == "status") {
      EXPECT_EQ(list[i].at("values").at("0"), "ok");
      EXPECT_EQ(list[i].at("values").at("-1"), "no_match");
    }
    if (list[i].at("name") == "rotation_1") {
      EXPECT_EQ(list[i].at("scale_by_convention").at("ur_rotation_vector"), 1e-6);
    }
  }
  for (const char* name : {"command_number", "position_x_f", "further_8_number_tail"})
    EXPECT_EQ(names.count(name), 1U) << name;
}

TEST(MapCommand, CsvHasALineAnEntryAndAsManyFields) {
  const std::string text = run({"map", "--format", "csv"}).out;
  EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')),
            result_map::entries().size() + 1);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    bool is_inside = false;
    int commas = 0;
    for (const char c : line) {
      if (c == '"') is_inside = !is_inside;
      if (c == ',' && !is_inside) ++commas;
    }
    EXPECT_EQ(commas, 10) << line;
    EXPECT_FALSE(is_inside);
  }
}

TEST(MapCommand, ObjectsAreHexadecimalWhereverPeopleReadThem) {
  EXPECT_NE(run({"map", "--format", "csv"})
                .out.find("\nsession_id,input,110,1,uint16,1,,\"\",0x2010,0x0B,"),
            std::string::npos);
  EXPECT_NE(run({"map"}).out.find("| 110 | 400111 | 300111 | 2010:0B | `session_id` |"),
            std::string::npos);
  const std::string eds = run({"map", "--format", "eds"}).out;
  EXPECT_NE(eds.find("[2010subB]\nParameterName=session_id\n"), std::string::npos);
}

TEST(MapCommand, TheHeaderIsC) {
  EXPECT_EQ(flatpose_registers_in_c(0), 0);
  EXPECT_EQ(flatpose_registers_in_c(1), 101);
  EXPECT_EQ(flatpose_registers_in_c(2), -1);
  EXPECT_EQ(flatpose_registers_in_c(3), 16);
  EXPECT_EQ(flatpose_registers_in_c(4), 7);
}

// No compiler for it is at hand: at least blocks close, and all that is used is declared.
TEST(MapCommand, FunctionBlocksCloseWhatTheyOpenAndDeclareWhatTheyUse) {
  for (const PlcDialect dialect : {PlcDialect::kCodesys, PlcDialect::kScl}) {
    std::istringstream text(map_function_block(dialect));
    int depth = 0, parentheses = 0;
    bool is_code = false;
    std::set<std::string> declared, used;
    for (std::string line; std::getline(text, line);) {
      line = line.substr(0, line.find("//"));
      std::istringstream words(line);
      std::string first, second;
      words >> first >> second;
      if (first == "IF") ++depth;
      if (first == "END_IF;") --depth;
      ASSERT_GE(depth, 0);
      const bool is_local = std::islower(static_cast<unsigned char>(first.c_str()[0]));
      if (!is_code && is_local && (second == ":" || second == "{InstructionName"))
        declared.insert(first);
      if (first == "END_VAR" && declared.count("uiNumber")) is_code = true;
      for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '(') ++parentheses;
        if (line[i] == ')') --parentheses;
        const bool starts = std::islower(static_cast<unsigned char>(line[i])) &&
                            (i == 0 || !std::isalnum(static_cast<unsigned char>(line[i - 1])));
        if (!is_code || !starts || (i > 0 && (line[i - 1] == '_' || line[i - 1] == '.'))) continue;
        std::size_t end = i;
        while (end < line.size() && std::isalnum(static_cast<unsigned char>(line[end]))) ++end;
        used.insert(line.substr(i, end - i));
      }
    }
    EXPECT_EQ(depth, 0);
    EXPECT_EQ(parentheses, 0);
    EXPECT_GT(used.size(), 20U);
    for (const std::string& name : used) EXPECT_TRUE(declared.count(name)) << name;
    for (const std::string& name : declared) EXPECT_TRUE(used.count(name)) << name;
  }
}

const result_map::Entry& entry_of(const json& line) {
  return *result_map::entry_at(line.at("address").get<int>());
}

TEST(MapCommand, TheDbcHasTheNodeAndTheFdIdentifierOfTheConfig) {
  const port::TemporaryFolder folder;
  const std::string path = folder.write("f.toml", "[can]\nnode = 33\nfd_frame_id = 0x6a1\n");
  const std::string text = run({"map", "--format", "dbc", "--config", path}).out;
  EXPECT_NE(text.find("BO_ 417 FLATPOSE_STATUS: 8"), std::string::npos);
  EXPECT_NE(text.find("BO_ 1697 FLATPOSE_RESULT: 64"), std::string::npos);
  EXPECT_NE(text.find("BA_ \"VFrameFormat\" BO_ 1697 14;"), std::string::npos);
  EXPECT_NE(run({"map", "--format", "dbc", "--node", "33"}).out.find("BO_ 1313 FLATPOSE_RESULT"),
            std::string::npos);
}

TEST(MapCommand, ShowsTheMapAsAConfigServesIt) {
  const port::TemporaryFolder folder;
  const std::string path = folder.write(
      "f.toml",
      "[modbus]\nword_order = \"CDAB\"\nno_pose_int32 = -1\nno_pose_float32 = -1e9\n[can]\nnode = "
      "33\n"
      "[[part]]\nname = \"pad\"\nfile = \"pad.fpt\"\n[[part]]\nname = \"disc\"\nfile = "
      "\"disc.fpt\"\n"
      "[[job]]\nnumber = 7\nparts = [\"disc\", \"pad\"]\nconvention = \"ur_rotation_vector\"\n");
  const json list = json::parse(run({"map", "--format", "json", "--config", path}).out);
  ASSERT_EQ(list.size(), result_map::entries().size());
  for (const json& line : list) {
    const result_map::Entry& entry = entry_of(line);
    SCOPED_TRACE(line["name"]);
    const bool is_int32 = entry.type == result_map::Type::kInt32;
    const bool is_float = entry.type == result_map::Type::kFloat32;
    const bool is_rotation = result_map::is_rotation(entry.field);
    EXPECT_EQ(line.value("word_order", ""), entry.words() == 2 ? "CDAB" : "");
    EXPECT_EQ(line["scale"], is_rotation && is_int32 ? 1e-6 : entry.scale);
    EXPECT_EQ(line["unit"], is_rotation ? "rad" : entry.unit);
    EXPECT_EQ(line.contains("none"), entry.may_be_none && (is_int32 || is_float));
    if (line.contains("none")) {
      EXPECT_EQ(line["none"], is_int32 ? json(-1) : json(-1e9F));
    }
    if (entry.field == result_map::Field::kJob) {
      EXPECT_EQ(line["values"]["7"], "disc, pad; frame scan, ur_rotation_vector");
    }
  }
  const auto text = [&](const char* format) {
    return run({"map", "--format", format, "--config", path}).out;
  };
  EXPECT_NE(text("markdown").find("| 7 | disc, pad; frame scan, ur_rotation_vector | x 1e-06 |"),
            std::string::npos);
  EXPECT_NE(text("c").find("FLATPOSE_WORD_ORDER \"CDAB\""), std::string::npos);
  EXPECT_NE(text("c").find("#define FLATPOSE_NONE_INT32 (0 - 1)"), std::string::npos);
  EXPECT_NE(text("st").find("xLowWordFirst : BOOL := TRUE;"), std::string::npos);
  EXPECT_NE(text("dbc").find("BO_ 417 FLATPOSE_STATUS: 8"), std::string::npos);
}

std::string dbc_of_jobs(std::initializer_list<const char*> conventions) {
  const port::TemporaryFolder folder;
  std::string text = "[[part]]\nname = \"pad\"\nfile = \"pad.fpt\"\n";
  int number = 0;
  for (const char* convention : conventions)
    text += "[[job]]\nnumber = " + std::to_string(++number) +
            "\nparts = [\"pad\"]\nconvention = \"" + convention + "\"\n";
  return run({"map", "--format", "dbc", "--config", folder.write("f.toml", text)}).out;
}

TEST(MapCommand, TheDbcScalesRotationsAsAllJobsHaveThem) {
  const auto has = [](const std::string& dbc, const std::string& text) {
    return dbc.find(text) != std::string::npos;
  };
  const std::string degrees = dbc_of_jobs({"kuka_abc", "fanuc_wpr"});
  EXPECT_TRUE(has(degrees, "rotation_1 : 32|24@1- (0.001,0) [-8388.607|8388.607] \"deg\" MASTER"));
  EXPECT_TRUE(has(degrees, "Rotations: 0.001 deg, as all jobs"));
  const std::string radians = dbc_of_jobs({"ur_rotation_vector", "ur_rotation_vector"});
  for (const char* signal :
       {"rotation_1 : 32|24@1-", "rotation_2 : 8|24@1-", "rotation_3 : 32|24@1-"})
    EXPECT_TRUE(
        has(radians, std::string(signal) + " (1e-06,0) [-8.388607|8.388607] \"rad\" MASTER"))
        << signal;
  EXPECT_TRUE(has(radians, "rotation_4 : 256|32@1- (1e-06,0) [-2147.483647|2147.483647] \"rad\""));
  EXPECT_TRUE(has(radians, "Rotations: 1e-06 rad, as all jobs"));
  EXPECT_TRUE(has(dbc_of_jobs({"abb_quaternion"}),
                  "rotation_1 : 160|32@1- (1e-06,0) [-2147.483647|2147.483647] \"\" MASTER"));
  for (const std::string& mixed : {dbc_of_jobs({"kuka_abc", "ur_rotation_vector"}),
                                   dbc_of_jobs({"abb_quaternion", "ur_rotation_vector"})}) {
    EXPECT_TRUE(has(mixed, "rotation_1 : 32|24@1- (0.001,0) [-8388.607|8388.607] \"deg\" MASTER"));
    EXPECT_TRUE(has(mixed, "Rotations: the jobs of the config differ: 0.001 degree"));
  }
}

TEST(MapCommand, TheEdsStartsAsTheNodeDoes) {
  const std::string eds = run({"map", "--format", "eds"}).out;
  for (const char* text :
       {"ParameterName=The master's heartbeat\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\n"
        "DefaultValue=0x7F0000\n",
        "ParameterName=test_uint32\nObjectType=0x7\nDataType=0x0007\nAccessType=ro\n"
        "DefaultValue=0x12345678\n",
        "ParameterName=Manufacturer hardware version\nObjectType=0x7\nDataType=0x0009\n"
        "AccessType=const\nDefaultValue=-\n"})
    EXPECT_NE(eds.find(text), std::string::npos) << text;
  std::string version = run({"--version"}).out;  // "flatpose 0.1.0"
  version = version.substr(version.find(' ') + 1);
  EXPECT_NE(eds.find("DataType=0x0009\nAccessType=const\nDefaultValue=" + version),
            std::string::npos);
}

TEST(MapCommand, RefusesAConfigThatItCannotShow) {
  const port::TemporaryFolder folder;
  expect_refused(run({"map", "--config", folder.path("none.toml")}), 2, "none.toml");
  const std::string unknown = folder.write("u.toml", "[modbus]\nword_ordr = \"CDAB\"\n");
  expect_refused(run({"map", "--config", unknown}), 2, "word_order");
  const std::string bytes = folder.write("b.toml", "[modbus]\nword_order = \"DCBA\"\n");
  expect_refused(run({"map", "--format", "st", "--config", bytes}), 2, "DCBA");
  expect_refused(run({"map", "--format", "eds", "--config", bytes}), 2, "EDS");
}

TEST(MapCommand, RefusesWhatItCannotPrint) {
  expect_refused(run({"map", "--format", "dbc", "--node", "0"}), 2, "--node");
  expect_refused(run({"map", "--format", "dbc", "--node", "128"}), 2, "--node");
  expect_refused(run({"map", "--format", "xml"}), 2, "xml");
}

}  // namespace
}  // namespace flatpose::tool
