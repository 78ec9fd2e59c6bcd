// NodeSets of the OPC Foundation, from the npm package that the build and node-opcua use.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <regex>
#include <sstream>

#include "nodeset_texts.hpp"

namespace metier::opcua {
namespace {

using testing::serverWith;

std::filesystem::path official(const std::string& name) {
    return std::filesystem::path(METIER_OFFICIAL_NODESETS) / ("Opc.Ua." + name + ".NodeSet2.xml");
}

/// Loads NodeSets, or skips the test where the package is not installed.
class OfficialNodesets : public ::testing::Test {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(official("Machinery"))) {
            GTEST_SKIP() << "no " << official("Machinery") << ": scripts/setup installs it";
        }
    }

    void load(const std::vector<std::string>& names) {
        std::vector<std::filesystem::path> files;
        for (const auto& name : names) {
            files.push_back(name.ends_with(".xml")
                                ? std::filesystem::path(METIER_OFFICIAL_NODESETS) / name
                                : official(name));
        }
        auto server = serverWith(files);
        ASSERT_TRUE(server) << server.error().message;
        server_ = *std::move(server);
    }

    /// Checks that each node of a file whose ids are `ns=1;i=...` is there.
    void checkNodes(const std::string& name, std::string_view uri) const {
        std::ifstream file(official(name));
        std::stringstream text;
        text << file.rdbuf();
        const auto content = text.str();
        const auto index = server_->nodes().namespaceIndex(uri).value();
        const std::regex id("<UA[A-Za-z]+ [^>]*NodeId=\"ns=1;i=([0-9]+)\"");
        std::size_t count = 0;
        for (std::sregex_iterator each(content.begin(), content.end(), id), end; each != end;
             ++each) {
            const NodeId node(index, static_cast<std::uint32_t>(std::stoul((*each)[1])));
            EXPECT_TRUE(server_->nodes().exists(node)) << name << ": " << node.toString();
            ++count;
        }
        EXPECT_GT(count, 50U);
    }

    std::unique_ptr<Server> server_;
};

TEST_F(OfficialNodesets, OfMachineryPackMlAndMachineVisionLoad) {
    load({"Machinery", "PackML", "MachineVision"});
    checkNodes("Machinery", "http://opcfoundation.org/UA/Machinery/");
    checkNodes("PackML", "http://opcfoundation.org/UA/PackML/");
    checkNodes("MachineVision", "http://opcfoundation.org/UA/MachineVision");
}

TEST_F(OfficialNodesets, LetMachinesBeMade) {
    load({"Machinery"});
    auto& nodes = server_->nodes();
    const auto machinery = nodes.namespaceIndex("http://opcfoundation.org/UA/Machinery/").value();
    const auto machines = nodes.find(ids::kObjectsFolder, {machinery, "Machines"});
    ASSERT_TRUE(machines) << machines.error().message;
}

TEST_F(OfficialNodesets, ThatAreCompiledInAreNotLoadedAgain) {
    load({"Di", "Machinery"});
    EXPECT_TRUE(server_->nodes().namespaceIndex("http://opcfoundation.org/UA/Machinery/"));
}

TEST_F(OfficialNodesets, LoadAllTogetherQuickly) {
    const auto begun = std::chrono::steady_clock::now();
    load({"Opc.ISA95.NodeSet2.xml",
          "AMB",
          "Adi",
          "AutoID",
          "Opc.Ua.CNC.NodeSet.xml",
          "CommercialKitchenEquipment",
          "Opc.Ua.Eumabois.Nodeset2.xml",
          "Gds",
          "Glass",
          "IOLink",
          "IOLinkIODD",
          "IRDI",
          "Ijt.Base",
          "Ijt.Tightening",
          "MachineTool",
          "MachineVision",
          "Opc.Ua.Machinery.Jobs.Nodeset2.xml",
          "Machinery",
          "Machinery.ProcessValues",
          "Machinery.Result",
          "MetalForming",
          "PADIM",
          "PackML",
          "Woodworking",
          "opc.ua.isa95-jobcontrol.nodeset2.xml"});
    const auto took = std::chrono::steady_clock::now() - begun;
    // 150,000 lines; well under a second on an idle machine, without sanitizers.
    EXPECT_LT(took, std::chrono::seconds(30));
}

}  // namespace
}  // namespace metier::opcua
