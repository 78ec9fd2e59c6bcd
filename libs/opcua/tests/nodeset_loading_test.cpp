#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <open62541/client.h>
#include <open62541/client_config_default.h>
#include <open62541/client_highlevel.h>

#include "bare_client.hpp"
#include "common/convert.hpp"
#include "metier/opcua/server.hpp"
#include "nodeset_texts.hpp"

namespace metier::opcua {
namespace {

using testing::BareClient;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::NodesetFolder;
using testing::NodesetText;
using testing::serverWith;

constexpr const char* kDi = "http://opcfoundation.org/UA/DI/";

/// A type with a lamp, a machine of that type below Objects, and data types.
const std::string& machineNodes() {
    static const std::string nodes = R"(
<UAObject NodeId="ns=1;i=20" BrowseName="1:Press" EventNotifier="1"><DisplayName Locale="de">Presse</DisplayName>
  <DisplayName Locale="en">Press</DisplayName><Description>Presses.</Description>
  <References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">ns=1;i=10</Reference>
  <Reference ReferenceType="HasComponent">ns=1;s=Press.Lamp</Reference></References></UAObject>
<UAVariable NodeId="ns=1;s=Press.Lamp" BrowseName="1:Lamp" DataType="i=1" AccessLevel="3"><References>
  <Reference ReferenceType="HasTypeDefinition">i=63</Reference></References>
  <Value><uax:Boolean>true</uax:Boolean></Value></UAVariable>
<UAObjectType NodeId="ns=1;i=10" BrowseName="1:PressType"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">ns=1;i=9</Reference></References></UAObjectType>
<UAVariable NodeId="ns=1;i=11" BrowseName="1:Lamp" DataType="i=1"><References>
  <Reference ReferenceType="HasComponent" IsForward="false">ns=1;i=10</Reference>
  <Reference ReferenceType="i=37">i=78</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=63</Reference></References></UAVariable>
<UAMethod NodeId="ns=1;i=12" BrowseName="1:Stop"><References>
  <Reference ReferenceType="HasComponent" IsForward="false">ns=1;i=10</Reference>
  <Reference ReferenceType="HasComponent" IsForward="false">ns=1;i=20</Reference></References></UAMethod>
<UAObjectType NodeId="ns=1;i=9" BrowseName="1:MachineType" IsAbstract="true"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">i=58</Reference></References></UAObjectType>
<UAReferenceType NodeId="ns=1;i=4" BrowseName="1:Feeds" Symmetric="false"><InverseName>FedBy</InverseName><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">i=47</Reference></References></UAReferenceType>
<UAObject NodeId="ns=1;i=21" BrowseName="1:Belt"><References>
  <Reference ReferenceType="ns=1;i=4" IsForward="false">ns=1;i=20</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=58</Reference></References></UAObject>
<UAVariable NodeId="ns=1;i=22" BrowseName="1:Load" DataType="Double"><References>
  <Reference ReferenceType="HasComponent" IsForward="false">ns=1;i=21</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=63</Reference></References></UAVariable>
<UAView NodeId="ns=1;i=30" BrowseName="1:Maintenance"><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=87</Reference>
  <Reference ReferenceType="Organizes">ns=1;i=20</Reference></References></UAView>
)";
    return nodes;
}

class NodesetLoading : public ::testing::Test {
protected:
    void load(const std::vector<NodesetText>& texts) {
        std::vector<std::filesystem::path> files;
        for (const auto& text : texts) {
            files.push_back(folder_.write(text));
        }
        auto server = serverWith(files);
        ASSERT_TRUE(server) << server.error().message;
        server_ = *std::move(server);
    }

    /// A file with one Variable, ns=1;i=1, of that value.
    void loadValue(const std::string& attributes, const std::string& value,
                   const std::string& more = "") {
        load(
            {{.nodes =
                  R"(<UAVariable NodeId="ns=1;i=1" BrowseName="1:V" )" + attributes +
                  R"(><References><Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
<Reference ReferenceType="HasTypeDefinition">i=63</Reference></References><Value>)" +
                  value + "</Value></UAVariable>" + more}});
    }

    Value value() const { return nodes().read(id(1)).value().value; }

    AddressSpace& nodes() const { return server_->nodes(); }
    std::uint16_t index(std::string_view uri = "urn:test:machine") const {
        return nodes().namespaceIndex(uri).value_or(0);
    }
    NodeId id(std::uint32_t number) const { return {index(), number}; }

    NodesetFolder folder_;
    std::unique_ptr<Server> server_;
};

TEST_F(NodesetLoading, AddsObjectsWithTheirAttributes) {
    load({{.nodes = machineNodes()}});
    EXPECT_EQ(nodes().find(ids::kObjectsFolder, {index(), "Press"}).value(), id(20));
    EXPECT_EQ(nodes().descriptionOf(id(20))->text, "Presses.");
    const auto views = nodes().browse(NodeId(0, 87U)).value();
    ASSERT_EQ(views.size(), 1U);
    EXPECT_EQ(views[0].node_class, NodeClass::view);
    const auto below = nodes().browse(id(30)).value();
    ASSERT_EQ(below.size(), 1U);
    EXPECT_EQ(below[0].display_name, (LocalizedText{"de", "Presse"}));
    EXPECT_EQ(below[0].type_definition, id(10));
}

TEST_F(NodesetLoading, AddsReferencesBothWays) {
    load({{.nodes = machineNodes()}});
    // Noted at the child, at the parent, by a reference type of the file, and twice for a Method.
    EXPECT_EQ(nodes().find(id(10), {index(), "Lamp"}).value(), id(11));
    EXPECT_EQ(nodes().find(id(20), {index(), "Lamp"}).value(), NodeId(index(), "Press.Lamp"));
    EXPECT_EQ(nodes().find(id(20), {index(), "Belt"}).value(), id(21));
    EXPECT_EQ(nodes().find(id(20), {index(), "Stop"}).value(), id(12));
    EXPECT_EQ(nodes().find(id(10), {index(), "Stop"}).value(), id(12));
    const auto above = nodes().browse(id(21), {id(4), BrowseDirection::inverse}).value();
    ASSERT_EQ(above.size(), 1U);
    EXPECT_EQ(above[0].target, id(20));
}

TEST_F(NodesetLoading, LetsInstancesBeMadeOfItsTypes) {
    load({{.nodes = machineNodes()}});
    const auto made = nodes().addObject(
        {.node = {.parent = ids::kObjectsFolder, .browse_name = {index(), "Second"}},
         .type = id(10)});
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_TRUE(nodes().find(*made, {index(), "Lamp"}));
}

TEST_F(NodesetLoading, ServesItsNodesToClients) {
    load({{.nodes = machineNodes()}});
    const NodeId lamp(index(), "Press.Lamp");
    ASSERT_TRUE(server_->start());
    BareClient client;
    ASSERT_EQ(client.connect(server_->endpointUrl()), status::kGood);
    EXPECT_EQ(client.read(lamp).value.as<bool>(), true);
    EXPECT_EQ(client.write(lamp, Value::of(false)), status::kGood);
    EXPECT_EQ(client.read(lamp).value.as<bool>(), false);
    EXPECT_EQ(client.read(id(22)).status.name(), "BadWaitingForInitialData");
    EXPECT_EQ(client.readExecutable(id(12)), false);
    EXPECT_EQ(client.readUserExecutable(id(12)), false);
    EXPECT_EQ(client.call(id(20), id(12), {}).status.name(), "BadNotExecutable");
}

TEST_F(NodesetLoading, GivesWorkToItsMethods) {
    load({{.nodes = machineNodes()}});
    ASSERT_TRUE(nodes().setMethod(
        id(12), [](const CallContext&, std::span<const Value>) -> Result<std::vector<Value>> {
            return std::vector<Value>();
        }));
    ASSERT_TRUE(server_->start());
    BareClient client;
    ASSERT_EQ(client.connect(server_->endpointUrl()), status::kGood);
    EXPECT_EQ(client.call(id(20), id(12), {}).status, status::kGood);
}

TEST_F(NodesetLoading, TakesRequiredModelsFromFilesInAnyOrder) {
    load({{.model = "machine",
           .nodes = R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:Saw"><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">ns=2;i=5</Reference></References></UAObject>)",
           .required = {"urn:test:base"}},
          {.model = "base",
           .nodes = R"(<UAObjectType NodeId="ns=1;i=5" BrowseName="1:SawType"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">ns=2;i=1001</Reference></References></UAObjectType>)",
           .required = {kDi}}});
    const NodeId type(index("urn:test:base"), 5U);
    EXPECT_EQ(nodes().browse(ids::kObjectsFolder).value().back().type_definition, type);
    const auto above = nodes().browse(type, {ids::kHasSubtype, BrowseDirection::inverse}).value();
    ASSERT_EQ(above.size(), 1U);
    EXPECT_EQ(above[0].browse_name.name, "TopologyElementType");
}

TEST_F(NodesetLoading, LoadsACompiledRobotThatAFileRequires) {
    load({{.nodes = "", .required = {"https://fortiss.org/UA/iiwa/"}}});
    EXPECT_TRUE(nodes().namespaceIndex("https://fortiss.org/UA/iiwa/"));
    EXPECT_FALSE(nodes().namespaceIndex("https://fortiss.org/UA/edo/"));
}

TEST_F(NodesetLoading, LeavesOutAReferenceToANodeThatIsNotThere) {
    load({{.nodes = R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:Saw"><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="Organizes">ns=1;i=77</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=58</Reference></References></UAObject>)"}});
    EXPECT_TRUE(nodes().browse(id(1)).value().empty());
}

TEST_F(NodesetLoading, NamesItsDisplayNameAfterTheBrowseName) {
    load({{.nodes = R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:Saw"><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=58</Reference></References></UAObject>)"}});
    EXPECT_EQ(nodes().browse(ids::kObjectsFolder).value().back().display_name.text, "Saw");
}

TEST_F(NodesetLoading, ReadsNumbers) {
    loadValue(R"(DataType="i=26")", "<uax:UInt16> 7 </uax:UInt16>");
    EXPECT_EQ(value().as<std::uint16_t>(), 7);
    loadValue(R"(DataType="i=290")", "<Double>-1.5e3</Double>");
    EXPECT_EQ(value().as<double>(), -1500.0);
    loadValue(R"(DataType="i=10")", "<uax:Float>-INF</uax:Float>");
    EXPECT_EQ(value().as<float>(), -std::numeric_limits<float>::infinity());
    loadValue(R"(DataType="i=3" ValueRank="1")",
              "<uax:ListOfByte><uax:Byte>1</uax:Byte><uax:Byte>255</uax:Byte></uax:ListOfByte>");
    EXPECT_EQ(value().as<std::vector<std::uint8_t>>(), (std::vector<std::uint8_t>{1, 255}));
    loadValue(R"(DataType="Double" ValueRank="1")", "<uax:ListOfDouble/>");
    EXPECT_EQ(value().as<std::vector<double>>(), std::vector<double>());
}

TEST_F(NodesetLoading, ReadsAMatrix) {
    loadValue(
        R"(DataType="Double" ValueRank="2" ArrayDimensions="2,2")",
        R"(<uax:Matrix><uax:Dimensions><uax:UInt32>2</uax:UInt32><uax:UInt32>2</uax:UInt32></uax:Dimensions>
<uax:Elements><uax:Double>1</uax:Double><uax:Double>2</uax:Double><uax:Double>3</uax:Double><uax:Double>4</uax:Double></uax:Elements></uax:Matrix>)");
    EXPECT_EQ(value().asRows(), (std::vector<std::vector<double>>{{1, 2}, {3, 4}}));
}

TEST_F(NodesetLoading, ReadsTexts) {
    loadValue(R"(DataType="i=12")", "<uax:String> a &lt; b </uax:String>");
    EXPECT_EQ(value().as<std::string>(), " a < b ");
    loadValue(R"(DataType="i=21" ValueRank="1")",
              "<uax:ListOfLocalizedText><uax:LocalizedText><uax:Locale>en</uax:Locale>"
              "<uax:Text>Open</uax:Text></uax:LocalizedText><uax:LocalizedText/>"
              "</uax:ListOfLocalizedText>");
    EXPECT_EQ(value().as<std::vector<LocalizedText>>(),
              (std::vector<LocalizedText>{{"en", "Open"}, {"", ""}}));
    loadValue(R"(DataType="i=20")",
              "<uax:QualifiedName><uax:NamespaceIndex>1</uax:NamespaceIndex><uax:Name>Lamp"
              "</uax:Name></uax:QualifiedName>");
    EXPECT_EQ(value().as<QualifiedName>(), (QualifiedName{index(), "Lamp"}));
}

TEST_F(NodesetLoading, ReadsIdsAndTimes) {
    loadValue(R"(DataType="i=17")",
              "<uax:NodeId><uax:Identifier>ns=1;s=Press.Lamp</uax:Identifier></uax:NodeId>");
    EXPECT_EQ(value().as<NodeId>(), NodeId(index(), "Press.Lamp"));
    loadValue(R"(DataType="i=14")",
              "<uax:Guid><uax:String>01020304-0506-0708-090a-0b0c0d0e0f10</uax:String></uax:Guid>");
    EXPECT_EQ(value().as<Guid>()->data1, 0x01020304U);
    loadValue(R"(DataType="i=15")", "<uax:ByteString>AQ\nID</uax:ByteString>");
    EXPECT_EQ(value().as<ByteString>()->bytes, (std::vector<std::uint8_t>{1, 2, 3}));
    loadValue(R"(DataType="i=13")", "<uax:DateTime>2024-05-01T12:00:00.5+02:00</uax:DateTime>");
    EXPECT_EQ(value().toString(), "\"2024-05-01T10:00:00.5Z\"");
}

/// A value in an ExtensionObject.
std::string structure(const std::string& encoding, const std::string& body) {
    return "<uax:ExtensionObject><uax:TypeId><uax:Identifier>" + encoding +
           "</uax:Identifier></uax:TypeId><uax:Body>" + body + "</uax:Body></uax:ExtensionObject>";
}

TEST_F(NodesetLoading, ReadsStructuresOfTheStandard) {
    loadValue(R"(DataType="i=884")",
              structure("i=885",
                        "<uax:Range><uax:Low>-1</uax:Low><uax:High>2.5</uax:High>"
                        "</uax:Range>"));
    EXPECT_EQ(value().as<Range>(), (Range{-1.0, 2.5}));
    loadValue(R"(DataType="i=887")",
              structure("i=888",
                        "<uax:EUInformation><uax:NamespaceUri>u</uax:NamespaceUri><uax:UnitId>5"
                        "</uax:UnitId><uax:DisplayName><uax:Text>mm</uax:Text></uax:DisplayName>"
                        "</uax:EUInformation>"));
    EXPECT_EQ(value().as<EuInformation>(), (EuInformation{"u", 5, {"", "mm"}, {}}));
    loadValue(R"(DataType="i=296" ValueRank="1")",
              "<uax:ListOfExtensionObject>" +
                  structure("i=297",
                            "<uax:Argument><uax:Name>Speed</uax:Name><uax:DataType><uax:Identifier>"
                            "i=11</uax:Identifier></uax:DataType><uax:ValueRank>1</uax:ValueRank>"
                            "<uax:ArrayDimensions><uax:UInt32>6</uax:UInt32></uax:ArrayDimensions>"
                            "</uax:Argument>") +
                  "</uax:ListOfExtensionObject>");
    EXPECT_EQ(value().as<std::vector<Argument>>(),
              (std::vector<Argument>{{"Speed", ids::kDouble, 1, {6}, {}}}));
}

TEST_F(NodesetLoading, KeepsTheXmlOfAStructureThatItDoesNotKnow) {
    loadValue(R"(DataType="i=22")", structure("ns=1;i=88", "<Secret><A>1</A></Secret>"));
    EXPECT_THAT(value().toJson(), HasSubstr("<Secret><A>1</A></Secret>"));
}

/// Data types 40 to 44 of a file, and their encodings.
constexpr const char* kDataTypes = R"(
<UADataType NodeId="ns=1;i=40" BrowseName="1:Part"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">i=22</Reference>
  <Reference ReferenceType="i=38">ns=1;i=50</Reference><Reference ReferenceType="i=38">ns=1;i=60</Reference></References>
  <Definition Name="1:Part"><Field Name="Kind" DataType="ns=1;i=41"/><Field Name="Flag" DataType="i=1"/>
   <Field Name="Mass" DataType="Double"/><Field Name="holes" DataType="ns=1;i=42" ValueRank="1"/>
   <Field Name="Names" DataType="i=12" ValueRank="1"/><Field Name="Parts" DataType="ns=1;i=40" ValueRank="1"/></Definition></UADataType>
<UADataType NodeId="ns=1;i=41" BrowseName="1:Kind"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">i=29</Reference></References>
  <Definition Name="1:Kind"><Field Name="Bolt" Value="0"/><Field Name="Plate" Value="3"/></Definition></UADataType>
<UADataType NodeId="ns=1;i=42" BrowseName="1:Hole"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">i=22</Reference></References>
  <Definition Name="1:Hole"><Field Name="Diameter" DataType="i=10"/><Field Name="Depth" DataType="Double" IsOptional="true"/>
   <Field Name="Note" DataType="i=12" IsOptional="true"/></Definition></UADataType>
<UADataType NodeId="ns=1;i=43" BrowseName="1:Size"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">i=12756</Reference>
  <Reference ReferenceType="i=38">ns=1;i=63</Reference></References>
  <Definition Name="1:Size" IsUnion="true"><Field Name="Small" DataType="i=3"/><Field Name="Named" DataType="i=12"/></Definition></UADataType>
<UADataType NodeId="ns=1;i=44" BrowseName="1:Cut"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">ns=1;i=42</Reference>
  <Reference ReferenceType="i=38">ns=1;i=64</Reference></References>
  <Definition Name="1:Cut"><Field Name="Angle" DataType="Double"/></Definition></UADataType>
<UAObject NodeId="ns=1;i=50" BrowseName="Default Binary"><References><Reference ReferenceType="HasTypeDefinition">i=76</Reference></References></UAObject>
<UAObject NodeId="ns=1;i=60" BrowseName="Default XML"><References><Reference ReferenceType="HasTypeDefinition">i=76</Reference></References></UAObject>
<UAObject NodeId="ns=1;i=63" BrowseName="Default XML"><References><Reference ReferenceType="HasTypeDefinition">i=76</Reference></References></UAObject>
<UAObject NodeId="ns=1;i=64" BrowseName="Default XML"><References><Reference ReferenceType="HasTypeDefinition">i=76</Reference></References></UAObject>
)";

constexpr const char* kPart = R"(<Part><Kind>Plate_3</Kind><Flag>true</Flag><Mass>1.5</Mass>
<Holes><Hole><EncodingMask>1</EncodingMask><Diameter>4</Diameter><Depth>9</Depth></Hole><Hole><Diameter>5</Diameter></Hole></Holes>
<Names><String>a</String><String>b</String></Names><Parts><Part><Mass>2</Mass></Part></Parts></Part>)";

// What a compiler makes of the structures above: the layout that the stack must have.
struct Hole {
    UA_Float diameter;
    UA_Double* depth;
    UA_String* note;
};
struct Part {
    UA_Int32 kind;
    UA_Boolean flag;
    UA_Double mass;
    std::size_t holes_size;
    Hole* holes;
    std::size_t names_size;
    UA_String* names;
    std::size_t parts_size;
    Part* parts;
};
struct Size {
    UA_UInt32 chosen;
    union {
        UA_Byte small;
        UA_String named;
    } fields;
};
struct Cut : Hole {
    UA_Double angle;
};

template <typename Structure>
const Structure& heldBy(const Value& value) {
    const auto& native = ValueAccess::native(value);
    EXPECT_EQ(native.type->memSize, sizeof(Structure));
    return *static_cast<const Structure*>(native.data);
}

TEST_F(NodesetLoading, ReadsStructuresOfTheFile) {
    loadValue(R"(DataType="ns=1;i=40")", structure("ns=1;i=60", kPart), kDataTypes);
    const auto held = value();
    EXPECT_EQ(held.dataType(), id(40));
    const auto& part = heldBy<Part>(held);
    EXPECT_EQ(part.kind, 3);
    EXPECT_TRUE(part.flag);
    EXPECT_EQ(part.mass, 1.5);
    ASSERT_EQ(part.holes_size, 2U);
    EXPECT_EQ(part.holes[0].diameter, 4.0F);
    EXPECT_EQ(*part.holes[0].depth, 9.0);
    EXPECT_EQ(part.holes[1].diameter, 5.0F);
    EXPECT_EQ(part.holes[1].depth, nullptr);
    ASSERT_EQ(part.names_size, 2U);
    EXPECT_EQ(textFrom(part.names[1]), "b");
    ASSERT_EQ(part.parts_size, 1U);
    EXPECT_EQ(part.parts[0].mass, 2.0);
}

TEST_F(NodesetLoading, ReadsAUnionAndAStructureBelowAnotherOne) {
    loadValue(R"(DataType="ns=1;i=43")",
              structure("ns=1;i=63", "<Size><SwitchField>2</SwitchField><Named>XL</Named></Size>"),
              kDataTypes);
    const auto size = value();
    EXPECT_EQ(heldBy<Size>(size).chosen, 2U);
    EXPECT_EQ(textFrom(heldBy<Size>(size).fields.named), "XL");
    loadValue(R"(DataType="ns=1;i=44")",
              structure("ns=1;i=64", "<Cut><Diameter>4</Diameter><Angle>0.5</Angle></Cut>"),
              kDataTypes);
    const auto cut = value();
    EXPECT_EQ(heldBy<Cut>(cut).diameter, 4.0F);
    EXPECT_EQ(heldBy<Cut>(cut).angle, 0.5);
}

TEST_F(NodesetLoading, RefusesTwoFieldsOfAUnion) {
    const auto file = folder_.write(
        {.nodes =
             R"(<UAVariable NodeId="ns=1;i=1" BrowseName="1:V" DataType="ns=1;i=43"><References>
<Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
<Reference ReferenceType="HasTypeDefinition">i=63</Reference></References><Value>)" +
             structure("ns=1;i=63", "<Size><Named>XL</Named><Small>1</Small></Size>") +
             "</Value></UAVariable>" + kDataTypes});
    const auto server = serverWith({file});
    ASSERT_FALSE(server);
    EXPECT_THAT(server.error().message, HasSubstr("a second field of a union"));
}

/// The fields that a client reads in the attribute DataTypeDefinition.
std::vector<std::string> definedFields(const Server& server, const NodeId& data_type) {
    constexpr auto kQuiet = [](void*, UA_LogLevel, UA_LogCategory, const char*, va_list) {};
    static UA_Logger silent{kQuiet, nullptr, nullptr};
    UA_ClientConfig config{};
    config.logging = &silent;
    UA_ClientConfig_setDefault(&config);
    UA_Client* client = UA_Client_newWithConfig(&config);
    std::vector<std::string> fields;
    EXPECT_EQ(UA_Client_connect(client, server.endpointUrl().c_str()), UA_STATUSCODE_GOOD);
    UA_ReadValueId item{};
    item.nodeId = viewOf(data_type);
    item.attributeId = UA_ATTRIBUTEID_DATATYPEDEFINITION;
    UA_ReadRequest request;
    UA_ReadRequest_init(&request);
    request.nodesToRead = &item;
    request.nodesToReadSize = 1;
    UA_ReadResponse response = UA_Client_Service_read(client, request);
    EXPECT_EQ(response.resultsSize, 1U);
    const auto& read = response.results[0].value;
    if (read.type == &UA_TYPES[UA_TYPES_STRUCTUREDEFINITION]) {
        const auto& definition = *static_cast<UA_StructureDefinition*>(read.data);
        for (std::size_t i = 0; i < definition.fieldsSize; ++i) {
            fields.push_back(textFrom(definition.fields[i].name));
        }
    }
    UA_ReadResponse_clear(&response);
    UA_Client_delete(client);
    return fields;
}

TEST_F(NodesetLoading, ShowsTheDefinitionOfStructures) {
    load({{.nodes = kDataTypes}});
    ASSERT_TRUE(server_->start());
    EXPECT_THAT(definedFields(*server_, id(40)),
                ElementsAre("Kind", "Flag", "Mass", "holes", "Names", "Parts"));
    EXPECT_THAT(definedFields(*server_, id(44)), ElementsAre("Diameter", "Depth", "Note", "Angle"));
}

TEST_F(NodesetLoading, TakesAWrittenStructureApart) {
    loadValue(R"(DataType="ns=1;i=40" AccessLevel="3")", structure("ns=1;i=60", kPart), kDataTypes);
    const auto before = value();
    ASSERT_TRUE(server_->start());
    BareClient client;
    ASSERT_EQ(client.connect(server_->endpointUrl()), status::kGood);
    const auto encoded = client.read(id(1)).value;  // the client does not know the type
    EXPECT_EQ(client.write(id(1), encoded), status::kGood);
    server_->stop();
    EXPECT_EQ(value(), before);
}

}  // namespace
}  // namespace metier::opcua
