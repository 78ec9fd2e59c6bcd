// The attribute DataTypeDefinition of enumerations, as clients read it.
#include <gmock/gmock.h>

#include <algorithm>

#include "bare_client.hpp"
#include "common/convert.hpp"
#include "nodeset_texts.hpp"

namespace metier::opcua {
namespace {

using testing::BareClient;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::NodesetFolder;
using ::testing::Not;
using ::testing::SizeIs;

constexpr std::uint32_t kDefinition = UA_ATTRIBUTEID_DATATYPEDEFINITION;

constexpr const char* kEnumerations = R"(
<UADataType NodeId="ns=1;i=41" BrowseName="1:Kind"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">i=29</Reference></References>
  <Definition Name="1:Kind"><Field Name="Bolt" Value="0"/><Field Name="Plate" Value="3">
    <DisplayName Locale="de">Platte</DisplayName><Description>Flat.</Description></Field></Definition></UADataType>
<UADataType NodeId="ns=1;i=42" BrowseName="1:Nothing"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">i=29</Reference></References></UADataType>
)";

struct Field {
    std::int64_t value;
    std::string name;
    LocalizedText display_name;
    LocalizedText description;
    bool operator==(const Field&) const = default;
};

std::vector<Field> fieldsOf(const DataValue& read) {
    const auto& held = ValueAccess::native(read.value);
    EXPECT_EQ(held.type, &UA_TYPES[UA_TYPES_ENUMDEFINITION]) << read.status.name();
    std::vector<Field> fields;
    if (held.type == &UA_TYPES[UA_TYPES_ENUMDEFINITION]) {
        const auto& definition = *static_cast<const UA_EnumDefinition*>(held.data);
        for (std::size_t i = 0; i < definition.fieldsSize; ++i) {
            const auto& field = definition.fields[i];
            fields.push_back({field.value, textFrom(field.name), fromNative(field.displayName),
                              fromNative(field.description)});
        }
    }
    return fields;
}

/// A server with the skill model and a file with enumerations.
class EnumDefinitions : public ::testing::Test {
protected:
    EnumDefinitions() {
        auto options = testing::testOptions();
        options.nodesets = {"metier"};
        options.nodeset_files = {folder_.write({.nodes = kEnumerations})};
        server_ = testing::makeServer(options);
    }
    void serve() {
        ASSERT_TRUE(server_->start());
        ASSERT_EQ(client_.connect(server_->endpointUrl()), status::kGood);
    }
    NodeId ofFile(std::uint32_t number) const {
        return {server_->nodes().namespaceIndex("urn:test:machine").value(), number};
    }
    NodeId named(const char* uri, const char* name) const {
        const QualifiedName wanted{server_->nodes().namespaceIndex(uri).value(), name};
        const auto types = server_->nodes().browse(ids::kEnumeration, {ids::kHasSubtype}).value();
        const auto found = std::find_if(types.begin(), types.end(), [&](const Reference& type) {
            return type.browse_name == wanted;
        });
        return found == types.end() ? NodeId() : found->target;
    }

    NodesetFolder folder_;
    std::unique_ptr<Server> server_;
    BareClient client_;
};

TEST_F(EnumDefinitions, AreMadeOfTheNamesOfACompiledNodeSet) {
    const auto reason = named("https://fortiss.org/UA/Device/", "SkillTransitionReason");
    serve();
    const auto fields = fieldsOf(client_.readAttribute(reason, kDefinition));
    ASSERT_EQ(fields.size(), 8U);
    EXPECT_EQ(fields[0], (Field{0, "None", {"en", "None"}, {}}));
    EXPECT_EQ(fields[7].value, 7);
    EXPECT_EQ(fields[7].name, "Limit");
}

TEST_F(EnumDefinitions, AreThoseOfAFile) {
    serve();
    EXPECT_THAT(fieldsOf(client_.readAttribute(ofFile(41), kDefinition)),
                ElementsAre(Field{0, "Bolt", {"", "Bolt"}, {}},
                            Field{3, "Plate", {"de", "Platte"}, {"", "Flat."}}));
}

TEST_F(EnumDefinitions, AreMadeOfNumberedValues) {
    serve();
    const NodeId node_class(0, std::uint32_t{UA_NS0ID_NODECLASS});
    const auto fields = fieldsOf(client_.readAttribute(node_class, kDefinition));
    ASSERT_THAT(fields, SizeIs(9));
    EXPECT_EQ(fields[8].value, 128);
    EXPECT_EQ(fields[8].name, "View");
}

TEST_F(EnumDefinitions, AreNoneWhereNobodyNamesTheValues) {
    serve();
    EXPECT_EQ(client_.readAttribute(ofFile(42), kDefinition).status.name(),
              "BadAttributeIdInvalid");
    EXPECT_EQ(client_.readAttribute(ids::kEnumeration, kDefinition).status.name(),
              "BadAttributeIdInvalid");
    EXPECT_EQ(client_.readAttribute(ids::kServer, kDefinition).status.name(),
              "BadAttributeIdInvalid");
}

TEST_F(EnumDefinitions, LeaveOtherAttributesAlone) {
    serve();
    EXPECT_EQ(client_.readAttribute(ofFile(41), UA_ATTRIBUTEID_VALUE).status.name(),
              "BadAttributeIdInvalid");
    ASSERT_THAT(fieldsOf(client_.readAttribute(ofFile(41), kDefinition)), Not(IsEmpty()));
    EXPECT_EQ(client_.readAttribute(ofFile(41), UA_ATTRIBUTEID_NODECLASS).value.as<std::int32_t>(),
              UA_NODECLASS_DATATYPE);
    EXPECT_EQ(client_.readAttribute(ofFile(41), UA_ATTRIBUTEID_VALUE).status.name(),
              "BadAttributeIdInvalid");
}

TEST_F(EnumDefinitions, AreSampledAgainAndAgain) {
    serve();
    ASSERT_GT(client_.subscribe(5.0), 0.0);
    std::vector<DataValue> definitions;
    std::vector<DataValue> ticks;
    ASSERT_EQ(client_.watchAttribute(ofFile(41), kDefinition, 5.0, definitions), status::kGood);
    // A value that changes with each sampling, by the same interval.
    ASSERT_EQ(client_.watchValue(NodeId(0, 2258U), 5.0, ticks), status::kGood);
    EXPECT_TRUE(client_.runUntil([&] { return ticks.size() > 5 && !definitions.empty(); }));
    ASSERT_THAT(definitions, SizeIs(1)) << "it did not change, and was not lost";
    EXPECT_THAT(fieldsOf(definitions[0]), SizeIs(2));
    EXPECT_THAT(fieldsOf(client_.readAttribute(ofFile(41), kDefinition)), SizeIs(2));
}

}  // namespace
}  // namespace metier::opcua
