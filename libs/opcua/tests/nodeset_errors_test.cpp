#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "metier/opcua/server.hpp"
#include "nodeset_texts.hpp"

namespace metier::opcua {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::NodesetFolder;
using testing::NodesetText;
using ::testing::Not;
using testing::serverWith;

class NodesetErrors : public ::testing::Test {
protected:
    /// The message with which files are refused; empty if they are not.
    static std::string refusal(const std::vector<std::filesystem::path>& files) {
        const auto server = serverWith(files);
        return server ? "" : server.error().message;
    }

    /// The same of a file with these nodes, which begin in line 12.
    std::string refusalOf(const std::string& nodes) const {
        return refusal({folder_.write({.nodes = nodes})});
    }

    NodesetFolder folder_;
};

constexpr const char* kLamp = R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:Lamp"><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=58</Reference></References></UAObject>
)";

/// A Variable `Speed` with attributes and a value, whose element begins in line 12.
std::string speed(const std::string& attributes, const std::string& value) {
    return R"(<UAVariable NodeId="ns=1;i=2" BrowseName="1:Speed" )" + attributes +
           R"(><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=63</Reference></References>
  <Value>)" +
           value + "</Value></UAVariable>";
}

TEST_F(NodesetErrors, NameAFileThatIsNotThere) {
    EXPECT_THAT(refusal({"/nowhere/Machine.xml"}), HasSubstr("/nowhere/Machine.xml: No such file"));
}

TEST_F(NodesetErrors, NameTheLineOfMalformedXml) {
    const auto file = folder_.write("broken.xml", "<UANodeSet>\n<Aliases>\n</UANodeSet>\n");
    EXPECT_THAT(refusal({file}), HasSubstr("broken.xml:3: Start-end tags mismatch"));
}

TEST_F(NodesetErrors, RefuseOtherXml) {
    const auto file = folder_.write("page.xml", "<html/>");
    EXPECT_THAT(refusal({file}), HasSubstr("page.xml:1: not a NodeSet: the element is html"));
}

TEST_F(NodesetErrors, RefuseAFileWithoutAModel) {
    const auto file = folder_.write("none.xml", "<UANodeSet/>");
    EXPECT_THAT(refusal({file}), HasSubstr("neither Models nor NamespaceUris"));
}

TEST_F(NodesetErrors, NameARequiredModelThatIsNowhere) {
    const auto file = folder_.write({.required = {"urn:test:none"}});
    EXPECT_THAT(refusal({file}),
                HasSubstr("machine.xml:7: the required model urn:test:none is neither in a listed "
                          "file nor compiled in"));
}

TEST_F(NodesetErrors, NameModelsThatRequireEachOther) {
    const auto files = {folder_.write({.model = "a", .required = {"urn:test:b"}}),
                        folder_.write({.model = "b", .required = {"urn:test:a"}})};
    EXPECT_THAT(refusal(files), HasSubstr("b.xml:7: models require each other: urn:test:a -> "
                                          "urn:test:b -> urn:test:a"));
}

TEST_F(NodesetErrors, NameAModelInTwoFiles) {
    const auto text = testing::textOf({.model = "a"});
    EXPECT_THAT(refusal({folder_.write("one.xml", text), folder_.write("two.xml", text)}),
                AllOf(HasSubstr("two.xml:6: the model urn:test:a is in"), HasSubstr("one.xml")));
}

TEST_F(NodesetErrors, NameANodeIdThatIsThereTwice) {
    EXPECT_THAT(refusalOf(std::string(kLamp) + kLamp),
                HasSubstr("machine.xml:15: the NodeId ns=1;i=1 is taken in line 12"));
}

TEST_F(NodesetErrors, NameAnUnknownParent) {
    EXPECT_THAT(refusalOf(R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:Lamp"><References>
  <Reference ReferenceType="Organizes" IsForward="false">ns=1;i=99</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=58</Reference></References></UAObject>)"),
                AllOf(HasSubstr("machine.xml:12: no parent ns="), HasSubstr(";i=99")));
}

TEST_F(NodesetErrors, NameAnUnknownType) {
    EXPECT_THAT(refusalOf(R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:Lamp"><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">ns=1;i=98</Reference></References></UAObject>)"),
                AllOf(HasSubstr("machine.xml:12: no type ns="), HasSubstr(";i=98")));
}

TEST_F(NodesetErrors, NameAnUnknownDataType) {
    EXPECT_THAT(refusalOf(speed(R"(DataType="ns=1;i=97")", "")),
                AllOf(HasSubstr("machine.xml:12: no data type ns="), HasSubstr(";i=97")));
}

TEST_F(NodesetErrors, NameAnObjectWithoutAType) {
    EXPECT_THAT(refusalOf(R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:Lamp"/>)"),
                HasSubstr("machine.xml:12: no HasTypeDefinition"));
}

TEST_F(NodesetErrors, NameAnAliasThatIsNotThere) {
    EXPECT_THAT(refusalOf(R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:Lamp"><References>
  <Reference ReferenceType="HasLamp" IsForward="false">i=85</Reference></References></UAObject>)"),
                HasSubstr("machine.xml:13: 'HasLamp' is not a NodeId"));
}

TEST_F(NodesetErrors, NameANamespaceThatTheFileDoesNotHave) {
    EXPECT_THAT(refusalOf(R"(<UAObject NodeId="ns=7;i=1" BrowseName="1:Lamp"/>)"),
                HasSubstr("machine.xml:12: NodeId: namespace 7, but NamespaceUris has 1"));
}

TEST_F(NodesetErrors, NameNodesThatAreAboveThemselves) {
    EXPECT_THAT(refusalOf(R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:A"><References>
  <Reference ReferenceType="HasComponent" IsForward="false">ns=1;i=2</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=58</Reference></References></UAObject>
<UAObject NodeId="ns=1;i=2" BrowseName="1:B"><References>
  <Reference ReferenceType="HasComponent" IsForward="false">ns=1;i=1</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=58</Reference></References></UAObject>)"),
                HasSubstr("machine.xml:12: a node is above itself"));
}

TEST_F(NodesetErrors, NameAValueThatIsNone) {
    EXPECT_THAT(refusalOf(speed(R"(DataType="Double")", "<uax:Double>fast</uax:Double>")),
                HasSubstr("machine.xml:15: 'fast' is no number"));
}

TEST_F(NodesetErrors, NameAValueOfAnotherType) {
    EXPECT_THAT(refusalOf(speed(R"(DataType="Double")", "<uax:String>1.5</uax:String>")),
                HasSubstr("machine.xml:15: a String is no value of the data type i=11"));
}

TEST_F(NodesetErrors, NameAListThatIsToBeScalar) {
    EXPECT_THAT(refusalOf(speed(R"(DataType="Double")",
                                "<uax:ListOfDouble><uax:Double>1</uax:Double></uax:ListOfDouble>")),
                HasSubstr("machine.xml:15: a Double[1] does not have ValueRank -1"));
}

TEST_F(NodesetErrors, NameANumberThatDoesNotFit) {
    EXPECT_THAT(refusalOf(speed(R"(DataType="i=3")", "<uax:Byte>256</uax:Byte>")),
                HasSubstr("machine.xml:15: '256' is no number from 0 to 255"));
}

TEST_F(NodesetErrors, NameAFieldThatAStructureDoesNotHave) {
    EXPECT_THAT(
        refusalOf(speed(R"(DataType="i=884")",
                        "<uax:ExtensionObject><uax:TypeId><uax:Identifier>i=885</uax:Identifier>"
                        "</uax:TypeId><uax:Body><uax:Range><uax:Lowest>1</uax:Lowest></uax:Range>"
                        "</uax:Body></uax:ExtensionObject>")),
        HasSubstr("machine.xml:15: Range has no field Lowest"));
}

TEST_F(NodesetErrors, AreReportedTogether) {
    const auto message = refusalOf(R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:A"/>
<UAObject NodeId="ns=1;i=2" BrowseName="1:B"/>)");
    EXPECT_THAT(message, AllOf(HasSubstr("machine.xml:12: "), HasSubstr("\n"),
                               HasSubstr("machine.xml:13: ")));
}

TEST_F(NodesetErrors, AreReportedUpToTwenty) {
    std::string nodes;
    for (int i = 1; i <= 25; ++i) {
        nodes += "<UAObject NodeId=\"ns=1;i=" + std::to_string(i) + "\" BrowseName=\"1:A\"/>\n";
    }
    EXPECT_THAT(refusalOf(nodes), AllOf(HasSubstr("machine.xml:31: "), HasSubstr("5 more"),
                                        Not(HasSubstr("machine.xml:32: "))));
}

TEST_F(NodesetErrors, SayNothingOfWhatIsBelowANodeThatIsMissing) {
    EXPECT_THAT(refusalOf(R"(<UAObject NodeId="ns=1;i=1" BrowseName="1:A"><References>
  <Reference ReferenceType="HasTypeDefinition">ns=1;i=98</Reference></References></UAObject>
<UAObject NodeId="ns=1;i=2" BrowseName="1:B"><References>
  <Reference ReferenceType="HasComponent" IsForward="false">ns=1;i=1</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=58</Reference></References></UAObject>)"),
                AllOf(HasSubstr("machine.xml:12: "), Not(HasSubstr("machine.xml:14: "))));
}

TEST_F(NodesetErrors, NameADeeplyNestedValue) {
    std::string value = "<uax:Double>1</uax:Double>";
    for (int i = 0; i < 1000; ++i) {
        value.insert(0, "<uax:Variant><uax:Value>");
        value += "</uax:Value></uax:Variant>";
    }
    EXPECT_THAT(refusalOf(speed(R"(DataType="i=24")", value)),
                HasSubstr("machine.xml:15: nested more than 64 times"));
}

}  // namespace
}  // namespace metier::opcua
