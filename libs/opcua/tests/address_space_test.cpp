#include "metier/opcua/address_space.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "bare_client.hpp"

namespace metier::opcua {
namespace {

using testing::BareClient;
using ::testing::HasSubstr;
using testing::makeServer;

const NodeId kCell{2, "Cell"};

/// A server whose Object `Cell` hangs below Objects.
class AddressSpaceTest : public ::testing::Test {
protected:
    AddressSpaceTest() : server_(makeServer()), nodes_(server_->nodes()) {
        EXPECT_TRUE(nodes_.addObject({{kCell, ids::kObjectsFolder, ids::kOrganizes, {2, "Cell"}}}));
    }

    NodeId addSpeed(Access access = Access::read_write) {
        VariableSpec spec;
        spec.node = {{}, kCell, ids::kHasComponent, {2, "Speed"}, {"en", "Speed"}, {"en", "m/s"}};
        spec.data_type = ids::kDouble;
        spec.value = Value::of(1.5);
        spec.access = access;
        return nodes_.addVariable(spec).value();
    }

    NodeId addDouble(MethodHandler handler) {
        MethodSpec spec;
        spec.node = {{}, kCell, ids::kHasComponent, {2, "Double"}};
        spec.inputs = {{"Number", ids::kDouble}};
        spec.outputs = {{"Twice", ids::kDouble}};
        spec.handler = std::move(handler);
        return nodes_.addMethod(spec).value();
    }

    /// Starts the server and connects the client; from now on nodes_ is the server thread's.
    void serve() {
        ASSERT_TRUE(server_->start());
        ASSERT_EQ(client_.connect(server_->endpointUrl()), status::kGood);
    }

    std::unique_ptr<Server> server_;
    AddressSpace& nodes_;
    BareClient client_;
};

TEST(ChildId, SaysWhereANodeIs) {
    EXPECT_EQ(childId(NodeId(2, "Cell"), {3, "Speed"}), NodeId(2, "Cell.Speed"));
    EXPECT_EQ(childId(NodeId(2, 17U), {3, "Speed"}), NodeId(2, "17.Speed"));
    EXPECT_EQ(childId(ids::kObjectsFolder, {3, "Speed"}), NodeId(3, "Speed"));
}

TEST_F(AddressSpaceTest, FindsNodesByPath) {
    const NodeId speed = addSpeed();
    EXPECT_EQ(speed, NodeId(2, "Cell.Speed"));
    EXPECT_EQ(nodes_.find(kCell, {2, "Speed"}), speed);
    EXPECT_EQ(nodes_.find(ids::kObjectsFolder, BrowsePath{{2, "Cell"}, {2, "Speed"}}), speed);
    EXPECT_TRUE(nodes_.exists(speed));
}

TEST_F(AddressSpaceTest, NamesThePathThatLeadsNowhere) {
    const auto missing = nodes_.find(kCell, BrowsePath{{2, "Speed"}, {0, "EURange"}});
    EXPECT_EQ(missing.error().code, Errc::not_found);
    EXPECT_THAT(missing.error().message, HasSubstr("2:Speed/0:EURange below ns=2;s=Cell"));
    EXPECT_EQ(nodes_.find(kCell, BrowsePath{}).error().code, Errc::invalid_argument);
    EXPECT_EQ(nodes_.find(NodeId(2, "none"), {2, "Speed"}).error().code, Errc::not_found);
}

TEST_F(AddressSpaceTest, BrowsesReferencesBothWays) {
    const NodeId speed = addSpeed();
    const auto children = nodes_.browse(kCell, {ids::kHasComponent});
    ASSERT_EQ(children->size(), 1U);
    const Reference& child = children->front();
    EXPECT_EQ(child.target, speed);
    EXPECT_EQ(child.type, ids::kHasComponent);
    EXPECT_EQ(child.browse_name, (QualifiedName{2, "Speed"}));
    EXPECT_EQ(child.display_name, (LocalizedText{"en", "Speed"}));
    EXPECT_EQ(child.node_class, NodeClass::variable);
    EXPECT_EQ(child.type_definition, ids::kBaseDataVariableType);
    const auto parents =
        nodes_.browse(speed, {ids::kHierarchicalReferences, BrowseFilter::Direction::inverse});
    ASSERT_EQ(parents->size(), 1U);
    EXPECT_EQ(parents->front().target, kCell);
    EXPECT_EQ(nodes_.browse(NodeId(2, "none")).error().code, Errc::not_found);
}

TEST_F(AddressSpaceTest, RefusesAnIdThatIsTaken) {
    const auto again =
        nodes_.addObject({{kCell, ids::kObjectsFolder, ids::kOrganizes, {2, "Other"}}});
    EXPECT_EQ(again.error().code, Errc::already_exists);
    EXPECT_THAT(again.error().message, HasSubstr("ns=2;s=Cell"));
}

TEST_F(AddressSpaceTest, RefusesAParentOrTypeThatDoesNotExist) {
    EXPECT_EQ(
        nodes_.addObject({{{}, NodeId(2, "none"), ids::kHasComponent, {2, "Lost"}}}).error().code,
        Errc::not_found);
    EXPECT_EQ(nodes_.addObject({{{}, kCell, ids::kHasComponent, {2, "Typeless"}}, NodeId(2, 77U)})
                  .error()
                  .code,
              Errc::not_found);
}

TEST_F(AddressSpaceTest, DeletesNodesWithTheirChildren) {
    const NodeId speed = addSpeed();
    ASSERT_TRUE(nodes_.deleteNode(kCell));
    EXPECT_FALSE(nodes_.exists(kCell));
    EXPECT_FALSE(nodes_.exists(speed));
    EXPECT_EQ(nodes_.deleteNode(kCell).error().code, Errc::not_found);
}

TEST_F(AddressSpaceTest, DeletesNodesThatHadHandlers) {
    const NodeId speed = addSpeed();
    ASSERT_TRUE(nodes_.setDataSource(
        speed, {[](const Session&) { return DataValue{Value::of(1.0)}; }, nullptr}));
    ASSERT_TRUE(nodes_.deleteNode(speed));
    const NodeId again = addSpeed();
    EXPECT_EQ(nodes_.read(again)->value, Value::of(1.5));
}

TEST_F(AddressSpaceTest, AddsReferencesOnce) {
    const NodeId speed = addSpeed();
    ASSERT_TRUE(nodes_.addReference(ids::kObjectsFolder, ids::kOrganizes, speed));
    EXPECT_EQ(nodes_.find(ids::kObjectsFolder, {2, "Speed"}), speed);
    EXPECT_EQ(nodes_.addReference(ids::kObjectsFolder, ids::kOrganizes, speed).error().code,
              Errc::already_exists);
    EXPECT_EQ(nodes_.addReference(kCell, ids::kOrganizes, NodeId(2, "none")).error().code,
              Errc::not_found);
}

TEST_F(AddressSpaceTest, ReadsAndWritesValuesItself) {
    const NodeId speed = addSpeed(Access::read);
    ASSERT_TRUE(nodes_.write(speed, Value::of(2.5)));
    EXPECT_EQ(nodes_.read(speed)->value, Value::of(2.5));
    EXPECT_EQ(nodes_.read(NodeId(2, "none")).error().code, Errc::not_found);
    EXPECT_EQ(nodes_.write(NodeId(2, "none"), Value::of(1.0)).error().code, Errc::not_found);
    const auto wrong = nodes_.write(speed, Value::of("fast"));
    EXPECT_EQ(wrong.error().code, Errc::type_mismatch);
    EXPECT_THAT(wrong.error().message, HasSubstr("String to ns=2;s=Cell.Speed"));
}

TEST_F(AddressSpaceTest, GivesClientsValueStatusAndTime) {
    const NodeId speed = addSpeed();
    const UtcTime when(std::chrono::milliseconds(1'700'000'000'000));
    ASSERT_TRUE(nodes_.write(speed, {Value::of(2.5), StatusCode(0x40000000), when, {}}));
    serve();
    const auto value = client_.read(speed);
    EXPECT_EQ(value.value, Value::of(2.5));
    EXPECT_EQ(value.status, StatusCode(0x40000000));
    EXPECT_EQ(value.source_time, when);
}

TEST_F(AddressSpaceTest, GivesClientsABadStatus) {
    const NodeId speed = addSpeed();
    ASSERT_TRUE(nodes_.write(speed, {Value(), status::kBadStateNotActive}));
    serve();
    EXPECT_EQ(client_.read(speed).status, status::kBadStateNotActive);
}

TEST_F(AddressSpaceTest, LetsClientsWriteOnlyWhereAllowed) {
    const NodeId speed = addSpeed(Access::read);
    serve();
    EXPECT_EQ(client_.write(speed, Value::of(9.0)), status::kBadNotWritable);
    ASSERT_TRUE(server_->call([&] { return nodes_.setAccess(speed, Access::read_write); }));
    EXPECT_EQ(client_.write(speed, Value::of(9.0)), status::kGood);
    EXPECT_EQ(client_.read(speed).value, Value::of(9.0));
}

TEST_F(AddressSpaceTest, ReadsFromADataSource) {
    const NodeId speed = addSpeed();
    double now = 3.0;
    ASSERT_TRUE(nodes_.setDataSource(
        speed, {[&](const Session&) { return DataValue{Value::of(now)}; }, nullptr}));
    serve();
    EXPECT_EQ(client_.read(speed).value, Value::of(3.0));
    EXPECT_NE(client_.read(speed).source_time, UtcTime{});
    EXPECT_EQ(client_.write(speed, Value::of(4.0)), status::kBadWriteNotSupported);
}

/// A data source that takes speeds up to 2 m/s and keeps them.
class BoundedSpeed {
public:
    DataSource source() {
        return {[this](const Session&) { return DataValue{value_}; },
                [this](const WriteContext& context, const Value& value) -> Result<> {
                    writer_ = context.session;
                    METIER_ASSIGN(const auto speed, value.as<double>());
                    if (!(speed <= 2.0)) {
                        return fail(Errc::out_of_range, "over 2 m/s");
                    }
                    value_ = value;
                    return {};
                }};
    }
    const Session& writer() const { return writer_; }

private:
    Value value_ = Value::of(1.0);
    Session writer_;
};

TEST_F(AddressSpaceTest, ADataSourceTakesOrRefusesWhatClientsWrite) {
    const NodeId speed = addSpeed();
    BoundedSpeed bounded;
    ASSERT_TRUE(nodes_.setDataSource(speed, bounded.source()));
    serve();
    EXPECT_EQ(client_.write(speed, Value::of(2.0)), status::kGood);
    EXPECT_EQ(client_.write(speed, Value::of(2.1)), status::kBadOutOfRange);
    EXPECT_EQ(client_.write(speed, Value::of(std::numeric_limits<double>::quiet_NaN())),
              status::kBadOutOfRange);
    EXPECT_EQ(client_.write(speed, Value::of("fast")), status::kBadTypeMismatch);
    EXPECT_EQ(client_.write(speed, Value::of(std::vector<double>{1.0})), status::kBadTypeMismatch);
    EXPECT_EQ(client_.write(speed, Value()), status::kBadTypeMismatch);
    EXPECT_EQ(client_.read(speed).value, Value::of(2.0));
    EXPECT_EQ(bounded.writer().application_name, "bare client");
}

TEST_F(AddressSpaceTest, ADataSourceTakesNoValueThatItsWriterCallsBadOrUncertain) {
    const NodeId speed = addSpeed();
    BoundedSpeed bounded;
    ASSERT_TRUE(nodes_.setDataSource(speed, bounded.source()));
    serve();
    const auto written = Value::of(2.0);
    EXPECT_EQ(client_.writeWithStatus(speed, written, StatusCode(UA_STATUSCODE_BADSENSORFAILURE)),
              status::kBadWriteNotSupported);
    EXPECT_EQ(client_.writeWithStatus(speed, written, StatusCode(UA_STATUSCODE_UNCERTAIN)),
              status::kBadWriteNotSupported);
    EXPECT_EQ(client_.read(speed).value, Value::of(1.0));
    EXPECT_EQ(client_.writeWithStatus(speed, written, status::kGood), status::kGood);
    EXPECT_EQ(client_.read(speed).value, Value::of(2.0));
}

TEST_F(AddressSpaceTest, TheServerWritesToADataSourceAsItself) {
    const NodeId speed = addSpeed();
    BoundedSpeed bounded;
    ASSERT_TRUE(nodes_.setDataSource(speed, bounded.source()));
    EXPECT_TRUE(nodes_.write(speed, Value::of(1.75)));
    EXPECT_TRUE(bounded.writer().id.isNull());
    EXPECT_EQ(nodes_.read(speed)->value, Value::of(1.75));
}

TEST_F(AddressSpaceTest, AnExceptionInADataSourceBecomesAStatus) {
    const NodeId speed = addSpeed();
    ASSERT_TRUE(nodes_.setDataSource(
        speed, {[](const Session&) -> DataValue { throw std::runtime_error("broken"); },
                [](const WriteContext&, const Value&) -> Result<> { throw std::bad_alloc(); }}));
    serve();
    EXPECT_EQ(client_.read(speed).status, status::kBadInternalError);
    EXPECT_EQ(client_.write(speed, Value::of(1.0)), status::kBadOutOfMemory);
}

TEST_F(AddressSpaceTest, CallsMethodsWithTheirArguments) {
    Session caller;
    const NodeId method =
        addDouble([&](const CallContext& context,
                      std::span<const Value> inputs) -> Result<std::vector<Value>> {
            caller = context.session;
            EXPECT_EQ(context.object, kCell);
            return std::vector{Value::of(2 * inputs[0].as<double>().value())};
        });
    serve();
    const auto result = client_.call(kCell, method, {Value::of(4.0)});
    EXPECT_EQ(result.status, status::kGood);
    ASSERT_EQ(result.outputs.size(), 1U);
    EXPECT_EQ(result.outputs[0], Value::of(8.0));
    EXPECT_EQ(caller.application_name, "bare client");
}

TEST_F(AddressSpaceTest, ChecksArgumentsBeforeTheHandlerIsCalled) {
    const NodeId method =
        addDouble([&](const CallContext&, std::span<const Value>) -> Result<std::vector<Value>> {
            ADD_FAILURE() << "called";
            return std::vector<Value>{};
        });
    serve();
    EXPECT_EQ(client_.call(kCell, method, {}).status, status::kBadArgumentsMissing);
    EXPECT_EQ(client_.call(kCell, method, {Value::of("4")}).status, status::kBadInvalidArgument);
    EXPECT_EQ(client_.call(kCell, method, {Value::of(1.0), Value::of(2.0)}).status,
              status::kBadTooManyArguments);
}

TEST_F(AddressSpaceTest, AMethodsRefusalReachesTheClient) {
    const NodeId method =
        addDouble([](const CallContext&, std::span<const Value>) -> Result<std::vector<Value>> {
            return fail(Errc::invalid_state, "not now");
        });
    serve();
    EXPECT_EQ(client_.call(kCell, method, {Value::of(1.0)}).status, status::kBadInvalidState);
}

TEST_F(AddressSpaceTest, AMethodThatThrowsOrForgetsItsOutputsFails) {
    bool throws = true;
    const NodeId method =
        addDouble([&](const CallContext&, std::span<const Value>) -> Result<std::vector<Value>> {
            if (throws) {
                throw std::runtime_error("broken");
            }
            return std::vector<Value>{};
        });
    serve();
    EXPECT_EQ(client_.call(kCell, method, {Value::of(1.0)}).status, status::kBadInternalError);
    ASSERT_TRUE(server_->call([&] { throws = false; }));
    EXPECT_EQ(client_.call(kCell, method, {Value::of(1.0)}).status, status::kBadInternalError);
}

TEST_F(AddressSpaceTest, TellsClientsWhetherAMethodMayBeCalled) {
    bool allowed = false;
    const NodeId method = addDouble(
        [](const CallContext&, std::span<const Value> inputs) -> Result<std::vector<Value>> {
            return std::vector{inputs[0]};
        });
    ASSERT_TRUE(nodes_.setExecutable(method, [&](const Session&) { return allowed; }));
    serve();
    EXPECT_EQ(client_.readUserExecutable(method), false);
    EXPECT_EQ(client_.call(kCell, method, {Value::of(1.0)}).status, status::kGood);
    ASSERT_TRUE(server_->call([&] { allowed = true; }));
    EXPECT_EQ(client_.readUserExecutable(method), true);
}

TEST_F(AddressSpaceTest, HandlersNeedANode) {
    const NodeId none(2, "none");
    EXPECT_EQ(nodes_.setMethod(none, nullptr).error().code, Errc::not_found);
    EXPECT_EQ(nodes_.setDataSource(none, {}).error().code, Errc::not_found);
    EXPECT_EQ(nodes_.setExecutable(none, nullptr).error().code, Errc::not_found);
    EXPECT_EQ(nodes_.setEventNotifier(none, EventNotifier::none).error().code, Errc::not_found);
    EXPECT_EQ(nodes_.setAccess(none, Access::read).error().code, Errc::not_found);
}

TEST_F(AddressSpaceTest, InstancesHaveTheMandatoryChildrenOfTheirType) {
    const NodeId program = nodes_
                               .addObject({{{}, kCell, ids::kHasComponent, {2, "Program"}},
                                           ids::kProgramStateMachineType})
                               .value();
    EXPECT_EQ(program, NodeId(2, "Cell.Program"));
    EXPECT_EQ(nodes_.find(program, BrowsePath{{0, "CurrentState"}, {0, "Number"}}),
              NodeId(2, "Cell.Program.CurrentState.Number"));
}

/// An ObjectType is derived from a Program's; the handler of Start distinguishes two instances.
TEST_F(AddressSpaceTest, SharedMethodsTellTheirObject) {
    const NodeId start = nodes_.find(ids::kProgramStateMachineType, {0, "Start"}).value();
    std::vector<NodeId> started;
    ASSERT_TRUE(nodes_.setMethod(
        start,
        [&](const CallContext& context, std::span<const Value>) -> Result<std::vector<Value>> {
            started.push_back(context.object);
            return std::vector<Value>{};
        }));
    for (const auto* name : {"A", "B"}) {
        ASSERT_TRUE(nodes_.addObject(
            {{{}, kCell, ids::kHasComponent, {2, name}}, ids::kProgramStateMachineType}));
    }
    serve();
    EXPECT_EQ(client_.call(NodeId(2, "Cell.B"), start, {}).status, status::kGood);
    EXPECT_EQ(client_.call(NodeId(2, "Cell.A"), start, {}).status, status::kGood);
    const auto objects = server_->call([&] { return started; });
    EXPECT_EQ(*objects, (std::vector<NodeId>{NodeId(2, "Cell.B"), NodeId(2, "Cell.A")}));
}

TEST_F(AddressSpaceTest, HasNothingToTellOfANodeThatIsNotThere) {
    const NodeId nothing{2, "Nothing"};
    EXPECT_FALSE(nodes_.exists(nothing));
    EXPECT_EQ(nodes_.shapeOf(nothing).error().code, Errc::not_found);
    EXPECT_EQ(nodes_.browseNameOf(nothing).error().code, Errc::not_found);
    EXPECT_EQ(nodes_.descriptionOf(nothing).error().code, Errc::not_found);
    EXPECT_EQ(nodes_.browse(nothing).error().code, Errc::not_found);
    EXPECT_EQ(nodes_.deleteNode(nothing).error().code, Errc::not_found);
    EXPECT_EQ(nodes_.namespaceIndex("urn:nobody\x1b").error().message,
              "no namespace 'urn:nobody\xEF\xBF\xBD'");
}

TEST_F(AddressSpaceTest, HasNoValueOrShapeOfAnObject) {
    EXPECT_FALSE(nodes_.shapeOf(kCell));
    EXPECT_FALSE(nodes_.read(kCell));
    EXPECT_FALSE(nodes_.write(kCell, Value::of(1.5)));
    EXPECT_FALSE(nodes_.setDataSource(kCell, {}));
    EXPECT_FALSE(nodes_.setMethod(kCell, {}));
    EXPECT_TRUE(nodes_.exists(kCell)) << "as before";
}

}  // namespace
}  // namespace metier::opcua
