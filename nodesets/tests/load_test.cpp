// Loads all NodeSets into a bare server and reads back values of each kind that the compiler
// encodes.
#include "metier/nodesets/ids.hpp"
#include "metier/nodesets/nodesets.h"

#include <open62541/server_config_default.h>

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace metier::nodesets {
namespace {

struct ServerDeleter {
    void operator()(UA_Server* server) const { UA_Server_delete(server); }
};

struct Loader {
    const char* name;
    UA_StatusCode (*load)(UA_Server*);
};

constexpr std::array kLoaders{
    Loader{"di", namespace_di_generated},
    Loader{"ia", namespace_ia_generated},
    Loader{"rob", namespace_rob_generated},
    Loader{"device", namespace_device_generated},
    Loader{"robotics", namespace_robotics_generated},
    Loader{"metier", namespace_metier_generated},
    Loader{"iiwa", namespace_iiwa_generated},
    Loader{"edo", namespace_edo_generated},
    Loader{"universal_robots", namespace_universal_robots_generated},
    Loader{"wsg50", namespace_wsg50_generated},
};

/// A value read from the server, freed with it.
class Value {
public:
    explicit Value(UA_Variant variant) : variant_{variant} {}
    Value(const Value&) = delete;
    Value& operator=(const Value&) = delete;
    ~Value() { UA_Variant_clear(&variant_); }

    [[nodiscard]] bool holds(const UA_DataType& type) const { return variant_.type == &type; }
    [[nodiscard]] std::size_t length() const { return variant_.arrayLength; }
    template <typename T>
    [[nodiscard]] const T* as() const {
        return static_cast<const T*>(variant_.data);
    }

private:
    UA_Variant variant_;
};

class LoadedServer : public ::testing::Test {
protected:
    void SetUp() override {
        server_.reset(UA_Server_new());
        const auto begin = std::chrono::steady_clock::now();
        for (const auto& loader : kLoaders) {
            ASSERT_EQ(loader.load(server_.get()), UA_STATUSCODE_GOOD) << loader.name;
        }
        duration_ = std::chrono::steady_clock::now() - begin;
    }

    [[nodiscard]] UA_NodeId nodeId(std::string_view uri, std::uint32_t number) const {
        std::size_t index = 0;
        auto name = UA_String_fromChars(std::string{uri}.c_str());
        EXPECT_EQ(UA_Server_getNamespaceByName(server_.get(), name, &index), UA_STATUSCODE_GOOD)
            << uri;
        UA_String_clear(&name);
        return UA_NODEID_NUMERIC(static_cast<UA_UInt16>(index), number);
    }

    [[nodiscard]] Value read(std::string_view uri, std::uint32_t number) const {
        UA_Variant variant;
        UA_Variant_init(&variant);
        EXPECT_EQ(UA_Server_readValue(server_.get(), nodeId(uri, number), &variant),
                  UA_STATUSCODE_GOOD)
            << number;
        return Value{variant};
    }

    std::unique_ptr<UA_Server, ServerDeleter> server_;
    std::chrono::steady_clock::duration duration_{};
};

struct Model {
    const char* folder;
    std::string_view uri;
};

constexpr std::array kModels{
    Model{"device", device::kUri}, Model{"robotics", robotics::kUri},
    Model{"metier", skills::kUri}, Model{"iiwa", iiwa::kUri},
    Model{"edo", edo::kUri},       Model{"universal_robots", universal_robots::kUri},
    Model{"wsg50", wsg50::kUri},
};

/// NodeId to node class, as NodeIds.csv of a folder lists them.
std::map<std::uint32_t, std::string> listedNodes(const char* folder) {
    std::ifstream file{std::string{METIER_NODESETS_DIR} + "/" + folder + "/NodeIds.csv"};
    std::map<std::uint32_t, std::string> nodes;
    for (std::string line; std::getline(file, line);) {
        const auto first = line.find(',');
        const auto second = line.find(',', first + 1);
        const auto id = std::stoul(line.substr(first + 1, second - first - 1));
        nodes[static_cast<std::uint32_t>(id)] = line.substr(second + 1);
    }
    return nodes;
}

std::string className(UA_NodeClass node_class) {
    const std::map<UA_NodeClass, std::string> names{
        {UA_NODECLASS_OBJECT, "Object"},
        {UA_NODECLASS_VARIABLE, "Variable"},
        {UA_NODECLASS_METHOD, "Method"},
        {UA_NODECLASS_OBJECTTYPE, "ObjectType"},
        {UA_NODECLASS_DATATYPE, "DataType"},
        {UA_NODECLASS_VARIABLETYPE, "VariableType"},
        {UA_NODECLASS_REFERENCETYPE, "ReferenceType"},
    };
    return names.at(node_class);
}

using NumericId = std::pair<UA_UInt16, UA_UInt32>;

UA_UInt32 numberOf(const UA_NodeId& id) {
    return id.identifier
        .numeric;  // NOLINT(cppcoreguidelines-pro-type-union-access): the type of the stack
}

/// Everything below Root by hierarchical references; nodes with other than numeric ids are left
/// out.
std::set<NumericId> reachableNodes(UA_Server* server) {
    std::set<NumericId> seen;
    std::vector<NumericId> open{{0, UA_NS0ID_ROOTFOLDER}};
    while (!open.empty()) {
        const auto [index, number] = open.back();
        open.pop_back();
        UA_BrowseDescription description;
        UA_BrowseDescription_init(&description);
        description.nodeId = UA_NODEID_NUMERIC(index, number);
        description.referenceTypeId = UA_NODEID_NUMERIC(0, UA_NS0ID_HIERARCHICALREFERENCES);
        description.includeSubtypes = true;
        auto result = UA_Server_browse(server, 0, &description);
        for (std::size_t i = 0; i < result.referencesSize; ++i) {
            const auto& id = result.references[i].nodeId.nodeId;
            const NumericId found{id.namespaceIndex, numberOf(id)};
            if (id.identifierType == UA_NODEIDTYPE_NUMERIC && seen.insert(found).second) {
                open.push_back(found);
            }
        }
        UA_BrowseResult_clear(&result);
    }
    return seen;
}

std::string text(const UA_String& string) {
    const std::span bytes{string.data, string.length};
    return {bytes.begin(), bytes.end()};
}

TEST_F(LoadedServer, HoldsAllNodeSets) {
    const auto milliseconds = std::chrono::duration<double, std::milli>(duration_).count();
    std::cout << "loaded " << std::size(kLoaders) << " NodeSets in " << milliseconds << " ms\n";
    SUCCEED();
}

TEST_F(LoadedServer, HasEveryListedNodeWithItsClass) {
    for (const auto& model : kModels) {
        const auto listed = listedNodes(model.folder);
        EXPECT_FALSE(listed.empty()) << model.folder;
        for (const auto& [id, expected] : listed) {
            UA_NodeClass node_class{};
            ASSERT_EQ(UA_Server_readNodeClass(server_.get(), nodeId(model.uri, id), &node_class),
                      UA_STATUSCODE_GOOD)
                << model.folder << " " << id;
            EXPECT_EQ(className(node_class), expected) << model.folder << " " << id;
        }
    }
}

TEST_F(LoadedServer, AddsNoNodeThatIsNotListed) {
    const auto reachable = reachableNodes(server_.get());
    for (const auto& model : kModels) {
        const auto listed = listedNodes(model.folder);
        const auto index = nodeId(model.uri, 1).namespaceIndex;
        for (const auto& [found_index, number] : reachable) {
            EXPECT_TRUE(found_index != index || listed.contains(number))
                << model.folder << " " << number;
        }
    }
}

TEST_F(LoadedServer, LetsSkillControllerAndSystemNotifyOfEvents) {
    for (const auto id : {iiwa::kIiwaSystem, iiwa::kIiwaSystem_Controllers_IiwaController,
                          iiwa::kIiwaSystem_Controllers_IiwaController_Skills_JointPtpMoveSkill}) {
        UA_Byte notifier = 0;
        ASSERT_EQ(UA_Server_readEventNotifier(server_.get(), nodeId(iiwa::kUri, id), &notifier),
                  UA_STATUSCODE_GOOD);
        EXPECT_EQ(notifier, UA_EVENTNOTIFIER_SUBSCRIBE_TO_EVENT) << id;
    }
}

TEST_F(LoadedServer, ArrangesAGripperAsPublishedClientsLookForIt) {
    for (const auto id : {wsg50::kWsg50, wsg50::kWsg50_Skills_GraspGripperSkill}) {
        UA_Byte notifier = 0;
        ASSERT_EQ(UA_Server_readEventNotifier(server_.get(), nodeId(wsg50::kUri, id), &notifier),
                  UA_STATUSCODE_GOOD);
        EXPECT_EQ(notifier, UA_EVENTNOTIFIER_SUBSCRIBE_TO_EVENT) << id;
    }
    const auto range = read(wsg50::kUri, wsg50::kWsg50_GripPoints_Tip_Range);
    ASSERT_TRUE(range.holds(UA_TYPES[UA_TYPES_RANGE]));
    EXPECT_DOUBLE_EQ(range.as<UA_Range>()->high, 0.11);
    UA_QualifiedName name;
    const auto force =
        nodeId(wsg50::kUri, wsg50::kWsg50_Skills_GraspGripperSkill_ParameterSet_Force);
    ASSERT_EQ(UA_Server_readBrowseName(server_.get(), force, &name), UA_STATUSCODE_GOOD);
    EXPECT_EQ(name.namespaceIndex, nodeId(device::kUri, 1).namespaceIndex);
    UA_QualifiedName_clear(&name);
}

TEST_F(LoadedServer, KeepsTheEURangeOfAParameter) {
    const auto value =
        read(robotics::kUri,
             robotics::kIJointMoveSkillParameterType_ParameterSet_TargetJointPosition_EURange);
    ASSERT_TRUE(value.holds(UA_TYPES[UA_TYPES_RANGE]));
    EXPECT_DOUBLE_EQ(value.as<UA_Range>()->low, -6.5);
    EXPECT_DOUBLE_EQ(value.as<UA_Range>()->high, 6.5);
}

TEST_F(LoadedServer, KeepsTheUnitOfAParameter) {
    const auto value =
        read(robotics::kUri, robotics::kPtpMoveSkillType_ParameterSet_MaxVelocity_EngineeringUnits);
    ASSERT_TRUE(value.holds(UA_TYPES[UA_TYPES_EUINFORMATION]));
    const auto& unit = *value.as<UA_EUInformation>();
    EXPECT_EQ(unit.unitId, 12865);
    EXPECT_EQ(text(unit.displayName.text), "rad/s");
    EXPECT_EQ(text(unit.namespaceUri), "http://www.opcfoundation.org/UA/units/un/cefact");
}

TEST_F(LoadedServer, KeepsTheNamesOfAnEnumeration) {
    const auto value = read(device::kUri, device::kGripTypeEnumeration_EnumStrings);
    ASSERT_TRUE(value.holds(UA_TYPES[UA_TYPES_LOCALIZEDTEXT]));
    ASSERT_EQ(value.length(), 3U);
    EXPECT_EQ(text(value.as<UA_LocalizedText>()[1].text), "VACUUM");
}

TEST_F(LoadedServer, KeepsTheArgumentsOfAMethod) {
    const auto value =
        read(robotics::kUri, robotics::kSkillMotionDeviceType_FlangeToolSet_InputArguments);
    ASSERT_TRUE(value.holds(UA_TYPES[UA_TYPES_ARGUMENT]));
    ASSERT_EQ(value.length(), 5U);
    const auto& frame = value.as<UA_Argument>()[1];
    EXPECT_EQ(text(frame.name), "Frame");
    EXPECT_EQ(numberOf(frame.dataType), UA_NS0ID_THREEDFRAME);
    EXPECT_EQ(frame.valueRank, UA_VALUERANK_SCALAR);
}

TEST_F(LoadedServer, KeepsTheDataTypeOfAnArgumentOfAnotherNamespace) {
    const auto value = read(
        iiwa::kUri,
        iiwa::
            kIiwaSystem_Controllers_IiwaController_Skills_JointPtpMoveSkill_StartWith_InputArguments);
    ASSERT_TRUE(value.holds(UA_TYPES[UA_TYPES_ARGUMENT]));
    ASSERT_EQ(value.length(), 5U);
    const auto expected = nodeId(skills::kUri, skills::kOwnerLossAction);
    EXPECT_TRUE(UA_NodeId_equal(&value.as<UA_Argument>()[2].dataType, &expected));
}

TEST_F(LoadedServer, KeepsAFrame) {
    const auto value =
        read(iiwa::kUri, iiwa::kIiwaSystem_MotionDevices_Iiwa_ParameterSet_WorldToRobotBase);
    ASSERT_TRUE(value.holds(UA_TYPES[UA_TYPES_THREEDFRAME]));
    EXPECT_DOUBLE_EQ(value.as<UA_ThreeDFrame>()->orientation.c, 0.0);
}

TEST_F(LoadedServer, GivesEachSkillItsOwnMethods) {
    const auto first = iiwa::kIiwaSystem_Controllers_IiwaController_Skills_JointPtpMoveSkill_Start;
    const auto second =
        iiwa::kIiwaSystem_Controllers_IiwaController_Skills_CartesianPtpMoveSkill_Start;
    UA_NodeClass node_class{};
    for (const auto id : {first, second}) {
        ASSERT_EQ(UA_Server_readNodeClass(server_.get(), nodeId(iiwa::kUri, id), &node_class),
                  UA_STATUSCODE_GOOD);
        EXPECT_EQ(node_class, UA_NODECLASS_METHOD);
    }
    EXPECT_NE(first, second);
}

}  // namespace
}  // namespace metier::nodesets
