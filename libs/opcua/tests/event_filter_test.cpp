#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <open62541/statuscodes.h>

#include <algorithm>
#include <map>
#include <set>

#include "bare_client.hpp"

namespace metier::opcua {
namespace {

using testing::BareClient;
using testing::BareFilter;
using ::testing::Each;
using testing::Element;
using ::testing::ElementsAre;
using testing::Field;
using testing::makeServer;
using testing::ReceivedEvent;
using testing::testOptions;

constexpr std::size_t kMostClauses = 64;  // of the stack's
constexpr StatusCode kBadBrowseNameInvalid(UA_STATUSCODE_BADBROWSENAMEINVALID);
constexpr StatusCode kBadTypeDefinitionInvalid(UA_STATUSCODE_BADTYPEDEFINITIONINVALID);

/// An event type of a server.
struct EventType {
    std::string name;
    std::vector<NodeId> above;  ///< from BaseEventType down
    std::set<BrowsePath> own;   ///< fields that it declares itself
};

void addFields(const AddressSpace& nodes, const NodeId& below, const BrowsePath& path,
               std::set<BrowsePath>& fields) {
    constexpr std::size_t kDeepest = 4;
    const auto children = nodes.browse(below).value();
    for (const auto& child : children) {
        const bool is_variable = child.node_class == NodeClass::variable;
        if ((!is_variable && child.node_class != NodeClass::object) || path.size() == kDeepest) {
            continue;
        }
        auto longer = path;
        longer.push_back(child.browse_name);
        if (is_variable) {
            fields.insert(longer);
        }
        addFields(nodes, child.target, longer, fields);
    }
}

void addTypes(const AddressSpace& nodes, const NodeId& type, std::vector<NodeId> above,
              std::map<NodeId, EventType>& types) {
    auto& added = types[type];
    added.name = nodes.browseNameOf(type).value().name;
    added.above = above;
    addFields(nodes, type, {}, added.own);
    above.push_back(type);
    const auto subtypes = nodes.browse(type, {ids::kHasSubtype}).value();
    for (const auto& below : subtypes) {
        addTypes(nodes, below.target, above, types);
    }
}

bool isAbove(const NodeId& upper, const NodeId& lower, const std::map<NodeId, EventType>& types) {
    const auto& above = types.at(lower).above;
    return upper == lower || std::find(above.begin(), above.end(), upper) != above.end();
}

/// Fields of a type and of all types above and below it.
std::set<BrowsePath> selectableBy(const NodeId& type, const std::map<NodeId, EventType>& types) {
    std::set<BrowsePath> fields;
    for (const auto& [other, declaration] : types) {
        if (isAbove(type, other, types) || isAbove(other, type, types)) {
            fields.insert(declaration.own.begin(), declaration.own.end());
        }
    }
    return fields;
}

/// Select clauses of one type, as many at once as a filter may have.
std::vector<std::vector<Field>> clauses(const NodeId& type, const std::set<BrowsePath>& paths) {
    std::vector<std::vector<Field>> filters;
    for (const auto& path : paths) {
        if (filters.empty() || filters.back().size() == kMostClauses) {
            filters.emplace_back();
        }
        filters.back().push_back({type, path});
    }
    return filters;
}

std::string textOf(const BrowsePath& path) {
    std::string text;
    for (const auto& name : path) {
        text += "/" + name.name;
    }
    return text;
}

/// A server with the whole skill model, which raises events of several types.
class EventFilterTest : public ::testing::Test {
protected:
    EventFilterTest() : server_(makeServer(withSkillModel())) {
        addTypes(server_->nodes(), ids::kBaseEventType, {}, types_);
        EXPECT_TRUE(server_->start());
        EXPECT_EQ(client_.connect(server_->endpointUrl()), status::kGood);
        EXPECT_GT(client_.subscribe(100), 0);
    }
    ~EventFilterTest() override {
        client_.disconnect();  // first: a bare client waits 5 s for a server that has ended
        server_->stop();
    }

    static ServerOptions withSkillModel() {
        auto options = testOptions();
        options.nodesets = {"metier"};
        return options;
    }

    NodeId typeNamed(const std::string& name) const {
        const auto found = std::find_if(types_.begin(), types_.end(),
                                        [&](const auto& each) { return each.second.name == name; });
        return found == types_.end() ? NodeId() : found->first;
    }

    /// Raises an event at the Server object.
    void raise(const NodeId& type, std::uint16_t severity) {
        const auto raised = server_->call([&]() -> Result<ByteString> {
            METIER_ASSIGN(auto emitter, EventEmitter::create(*server_, type, {}));
            Event event;
            event.source = ids::kServer;
            event.source_name = types_.at(type).name;
            event.time = std::chrono::system_clock::now();
            event.severity = severity;
            event.message = {"en", "raised"};
            return emitter.emit(event);
        });
        ASSERT_TRUE(raised) << raised.error().message;
    }

    /// Raises a SkillTransitionEventType of Severity 100, a ProgramTransitionEventType of 200 and a
    /// SystemEventType of 300.
    /// \return the names of the types that the filter lets through
    std::vector<std::string> namesThatPass(BareFilter& filter) {
        std::vector<ReceivedEvent> passed;
        std::vector<ReceivedEvent> all;
        BareFilter everything({{ids::kBaseEventType, {{0, "SourceName"}}}});
        filter.select({ids::kBaseEventType, {{0, "SourceName"}}});
        EXPECT_EQ(client_.watchEvents(ids::kServer, filter, passed).status, status::kGood);
        EXPECT_EQ(client_.watchEvents(ids::kServer, everything, all).status, status::kGood);
        raise(typeNamed("SkillTransitionEventType"), 100);
        raise(ids::kProgramTransitionEventType, 200);
        raise(ids::kSystemEventType, 300);
        EXPECT_TRUE(client_.runUntil([&] { return all.size() == 3; }));
        std::vector<std::string> names;
        for (const auto& event : passed) {
            names.push_back(event.back().as<std::string>().value());
        }
        return names;
    }

    std::unique_ptr<Server> server_;
    std::map<NodeId, EventType> types_;
    BareClient client_;
};

TEST_F(EventFilterTest, SelectsEveryFieldByEveryTypeAboveAndBelowItsOwn) {
    ASSERT_GT(types_.size(), 50U);
    std::vector<ReceivedEvent> events;
    for (const auto& [type, declaration] : types_) {
        for (const auto& fields : clauses(type, selectableBy(type, types_))) {
            BareFilter filter(fields);
            const auto result = client_.watchEvents(ids::kServer, filter, events);
            EXPECT_EQ(result.status, status::kGood) << declaration.name;
            for (std::size_t i = 0; i < result.clauses.size(); ++i) {
                EXPECT_EQ(result.clauses[i], status::kGood)
                    << declaration.name << " " << textOf(fields[i].path);
            }
        }
    }
}

TEST_F(EventFilterTest, RefusesTheFieldsThatNoRelatedTypeHas) {
    std::vector<ReceivedEvent> events;
    const auto all = selectableBy(ids::kBaseEventType, types_);
    for (const auto& [type, declaration] : types_) {
        const auto known = selectableBy(type, types_);
        std::set<BrowsePath> unknown{{{0, "NoSuchField"}}};
        std::set_difference(all.begin(), all.end(), known.begin(), known.end(),
                            std::inserter(unknown, unknown.end()));
        for (const auto& fields : clauses(type, unknown)) {
            BareFilter filter(fields);
            const auto result = client_.watchEvents(ids::kServer, filter, events);
            EXPECT_EQ(result.status, status::kBadNodeIdUnknown) << declaration.name;
            EXPECT_EQ(result.clauses.size(), fields.size());
            EXPECT_THAT(result.clauses, Each(status::kBadNodeIdUnknown)) << declaration.name;
        }
    }
}

TEST_F(EventFilterTest, DeliversTheSameValuesWhicheverTypeSelectsThem) {
    const auto skill_transition = typeNamed("SkillTransitionEventType");
    for (const auto& type : {ids::kBaseEventType, typeNamed("TransitionEventType"),
                             ids::kProgramTransitionEventType, skill_transition}) {
        std::vector<ReceivedEvent> events;
        BareFilter filter({{type, {{0, "EventType"}}},
                           {type, {{0, "SourceNode"}}},
                           {type, {{0, "Severity"}}},
                           {type, {{0, "Message"}}},
                           {type, {{0, "FromState"}, {0, "Number"}}},
                           {type, {{0, "LocalTime"}}}});
        ASSERT_EQ(client_.watchEvents(ids::kServer, filter, events).status, status::kGood);
        raise(skill_transition, 321);
        ASSERT_TRUE(client_.runUntil([&] { return !events.empty(); }));
        EXPECT_EQ(events[0][0], Value::of(skill_transition));
        EXPECT_EQ(events[0][1], Value::of(ids::kServer));
        EXPECT_EQ(events[0][2], Value::of(std::uint16_t{321}));
        EXPECT_EQ(events[0][3], Value::of(LocalizedText{"en", "raised"}));
        EXPECT_EQ(events[0][4], Value::of(std::uint32_t{0}));
        EXPECT_EQ(events[0][5].toString(), "[]") << "optional, and not there";
    }
}

TEST_F(EventFilterTest, ShowsNoTypeBelowItself) {
    for (const auto& [type, declaration] : types_) {
        const auto below = server_->call(
            [&id = type, this] { return server_->nodes().browse(id, {ids::kHasSubtype}); });
        ASSERT_TRUE(below);
        for (const auto& each : *below) {
            EXPECT_FALSE(isAbove(each.target, type, types_)) << declaration.name;
        }
    }
}

TEST_F(EventFilterTest, RefusesAClauseWithAnEmptyName) {
    std::vector<ReceivedEvent> events;
    BareFilter filter({{ids::kProgramTransitionEventType, {{0, "Message"}}},
                       {ids::kProgramTransitionEventType, {{0, ""}}},
                       {ids::kFolderType, {{0, "Message"}}}});
    const auto result = client_.watchEvents(ids::kServer, filter, events);
    EXPECT_THAT(result.clauses,
                ElementsAre(status::kGood, kBadBrowseNameInvalid, kBadTypeDefinitionInvalid));
}

/// Filters whose operands name the inherited field Severity by each of these types.
class WhereClause : public EventFilterTest, public ::testing::WithParamInterface<const char*> {
protected:
    Field severity() const { return {typeNamed(GetParam()), {{0, "Severity"}}}; }
    BareFilter filter_;
};

TEST_P(WhereClause, ComparesAnInheritedField) {
    filter_.where(UA_FILTEROPERATOR_EQUALS, {severity(), Value::of(std::uint16_t{200})});
    EXPECT_THAT(namesThatPass(filter_), ElementsAre("ProgramTransitionEventType"));
}

TEST_P(WhereClause, AndsItWithAType) {
    filter_.where(UA_FILTEROPERATOR_AND, {Element{1}, Element{2}});
    filter_.where(UA_FILTEROPERATOR_OFTYPE, {Value::of(ids::kProgramTransitionEventType)});
    filter_.where(UA_FILTEROPERATOR_LESSTHAN, {severity(), Value::of(std::uint16_t{200})});
    EXPECT_THAT(namesThatPass(filter_), ElementsAre("SkillTransitionEventType"));
}

TEST_P(WhereClause, OrsItWithAType) {
    filter_.where(UA_FILTEROPERATOR_OR, {Element{1}, Element{2}});
    filter_.where(UA_FILTEROPERATOR_OFTYPE, {Value::of(typeNamed("SkillTransitionEventType"))});
    filter_.where(UA_FILTEROPERATOR_EQUALS, {Value::of(std::uint16_t{300}), severity()});
    EXPECT_THAT(namesThatPass(filter_), ElementsAre("SkillTransitionEventType", "SystemEventType"));
}

TEST_P(WhereClause, NegatesIt) {
    filter_.where(UA_FILTEROPERATOR_NOT, {Element{1}});
    filter_.where(UA_FILTEROPERATOR_EQUALS, {severity(), Value::of(std::uint16_t{200})});
    EXPECT_THAT(namesThatPass(filter_), ElementsAre("SkillTransitionEventType", "SystemEventType"));
}

TEST_P(WhereClause, ComparesNoFieldThatTheEventLacks) {
    const Field absent{ids::kAuditEventType, {{0, "ServerId"}}};
    filter_.where(UA_FILTEROPERATOR_OR, {Element{1}, Element{2}});
    filter_.where(UA_FILTEROPERATOR_EQUALS, {severity(), Value::of(std::uint16_t{300})});
    filter_.where(UA_FILTEROPERATOR_OR, {Element{3}, Element{4}});
    filter_.where(UA_FILTEROPERATOR_EQUALS, {absent, Value::of("nobody")});
    filter_.where(UA_FILTEROPERATOR_EQUALS, {Value::of("nobody"), absent});
    EXPECT_THAT(namesThatPass(filter_), ElementsAre("SystemEventType"));
}

TEST_P(WhereClause, OrsAFieldThatTheEventLacks) {
    filter_.where(UA_FILTEROPERATOR_OR, {Element{1}, Field{ids::kAuditEventType, {{0, "Status"}}}});
    filter_.where(UA_FILTEROPERATOR_GREATERTHAN, {severity(), Value::of(std::uint16_t{150})});
    EXPECT_THAT(namesThatPass(filter_),
                ElementsAre("ProgramTransitionEventType", "SystemEventType"));
}

INSTANTIATE_TEST_SUITE_P(OfEachType, WhereClause,
                         ::testing::Values("BaseEventType", "TransitionEventType",
                                           "ProgramTransitionEventType", "SkillTransitionEventType",
                                           "SystemEventType"),
                         [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace metier::opcua
