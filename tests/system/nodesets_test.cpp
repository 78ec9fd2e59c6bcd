// NodeSet2.xml files that a cell file lists: what clients see of them, and how a server refuses
// them.
#include <gmock/gmock.h>

#include <fstream>

#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

using opcua::NodeId;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
namespace ids = opcua::ids;

const std::filesystem::path kSource(METIER_SOURCE_DIR);
const auto kOfficial = kSource / "tests/interop/node_modules/node-opcua-nodesets/nodesets";

/// A folder with a cell file of one simulated arm, and the NodeSet files that it lists.
class CellFolder {
public:
    CellFolder() {
        auto name = (std::filesystem::path(::testing::TempDir()) / "cell-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) {
            throw std::runtime_error("no folder for a cell");
        }
        folder_ = name;
    }
    ~CellFolder() {
        std::error_code error;
        std::filesystem::remove_all(folder_, error);
    }
    CellFolder(const CellFolder&) = delete;
    CellFolder& operator=(const CellFolder&) = delete;

    /// \param files names of NodeSets in this folder
    std::filesystem::path cell(const std::vector<std::string>& files) const {
        std::string list;
        for (const auto& file : files) {
            list += (list.empty() ? "\"" : ", \"") + file + "\"";
        }
        const auto path = folder_ / "cell.toml";
        std::ofstream(path) << "name = \"line\"\n[[server]]\nname = \"arm\"\nkind = \"arm\"\n"
                            << "driver = { type = \"simulator\" }\nmodel = "
                            << (kSource / "models/iiwa7.toml") << "\nnodesets = [" << list
                            << "]\nskills = [\"JointPtpMoveSkill\"]\n";
        return path;
    }

    void copy(const std::string& file) const {
        std::filesystem::copy_file(kOfficial / file, folder_ / file);
    }
    void write(const std::string& file, const std::string& text) const {
        std::ofstream(folder_ / file) << text;
    }

private:
    std::filesystem::path folder_;
};

/// The index of a namespace in the table of a server; throws if it is not there.
std::uint16_t indexOf(opcua::Client& client, const std::string& uri) {
    const auto table = client.read(NodeId(0, 2255U)).value().as<std::vector<std::string>>().value();
    const auto found = std::find(table.begin(), table.end(), uri);
    if (found == table.end()) {
        throw std::runtime_error("no namespace " + uri);
    }
    return static_cast<std::uint16_t>(found - table.begin());
}

/// BrowseNames of what is below a node.
std::vector<std::string> namesBelow(opcua::Client& client, const NodeId& node) {
    std::vector<std::string> names;
    const auto found = client.browse({.node = node}).value();
    for (const auto& reference : found) {
        names.push_back(reference.browse_name.name);
    }
    return names;
}

TEST(NodesetFiles, OfTheGuideAreServed) {
    EXPECT_THAT(sourceText("docs/guide/nodesets.md"),
                HasSubstr("```toml\n" + sourceText("cells/station.toml") + "```"));
    const ServerProcess server("iiwa", {"--port", "0"}, kSource / "cells/station.toml");
    const auto client = connectTo(server.url());
    const auto index = indexOf(*client, "urn:example:station");
    const auto station = client->translate(ids::kObjectsFolder, {{index, "Station4"}});
    ASSERT_TRUE(station);
    EXPECT_THAT(namesBelow(*client, *station),
                ::testing::UnorderedElementsAre("Number", "Material", "DeviceSet"));
    const auto material = client->translate(*station, {{index, "Material"}}).value();
    EXPECT_EQ(client->read(material).value().as<std::string>(), "steel");
    EXPECT_TRUE(client->write(material, opcua::Value::of("brass")));
    EXPECT_EQ(client->read(material).value().as<std::string>(), "brass");
    // The robot works as ever.
    auto skill = openSkill(*client, "JointPtpMoveSkill");
    auto target = jointPosition(*client, skill);
    target.back() += 0.05;
    EXPECT_TRUE(skill.run({{"TargetJointPosition", target}}, inAMinute()));
}

TEST(NodesetFiles, OfTheOpcFoundationCanBeBrowsed) {
    if (!std::filesystem::exists(kOfficial)) {
        GTEST_SKIP() << "no " << kOfficial << ": scripts/setup installs it";
    }
    const CellFolder folder;
    const std::vector<std::string> files{"Opc.Ua.Machinery.NodeSet2.xml",
                                         "Opc.Ua.PackML.NodeSet2.xml",
                                         "Opc.Ua.MachineVision.NodeSet2.xml"};
    for (const auto& file : files) {
        folder.copy(file);
    }
    const ServerProcess server("arm", {"--port", "0"}, folder.cell(files));
    const auto client = connectTo(server.url());
    const auto machinery = indexOf(*client, "http://opcfoundation.org/UA/Machinery/");
    EXPECT_TRUE(client->translate(ids::kObjectsFolder, {{machinery, "Machines"}}));
    const auto pack_ml = indexOf(*client, "http://opcfoundation.org/UA/PackML/");
    const auto types = namesBelow(*client, ids::kBaseObjectType);
    EXPECT_THAT(types, ::testing::Contains("PackMLBaseObjectType"));
    // PackMLObjects is an instance.
    EXPECT_TRUE(client->translate(ids::kObjectsFolder, {{pack_ml, "PackMLObjects"}}));
    const auto vision = indexOf(*client, "http://opcfoundation.org/UA/MachineVision");
    // VisionSystemType, and one of its Methods.
    EXPECT_THAT(namesBelow(*client, NodeId(vision, 1003U)),
                ::testing::Contains("VisionStateMachine"));
}

TEST(NodesetFiles, ThatMissAModelEndTheStart) {
    const CellFolder folder;
    folder.write("line.xml", R"(<UANodeSet><Models><Model ModelUri="urn:line">
<RequiredModel ModelUri="urn:none"/></Model></Models></UANodeSet>)");
    const auto run =
        runMetier({"serve", folder.cell({"line.xml"}).string(), "--server", "arm", "--port", "0"});
    EXPECT_NE(run.status, 0);
    EXPECT_THAT(run.output, HasSubstr("line.xml:2: the required model urn:none is neither in a "
                                      "listed file nor compiled in"));
}

TEST(NodesetFiles, ThatAreNotThereAreAnErrorOfTheCellFile) {
    const CellFolder folder;
    const auto run =
        runMetier({"serve", folder.cell({"none.xml"}).string(), "--server", "arm", "--port", "0"});
    EXPECT_NE(run.status, 0);
    EXPECT_THAT(run.output, AllOf(HasSubstr("cell.toml:"), HasSubstr("nodesets: no such file"),
                                  HasSubstr("none.xml"), Not(HasSubstr("line.xml"))));
}

}  // namespace
}  // namespace metier::system_tests
