#include "metier/records/trace.hpp"

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "json_text.hpp"
#include "metier/records/json.hpp"
#include "parts.hpp"

namespace metier::records {
namespace {

using nlohmann::ordered_json;

/// A composition that calls itself for ever does not exist; a damaged store might.
constexpr std::size_t kMostExecutions = 100'000;

/// The events of a trace, as they come.
class Trace {
public:
    Trace(Store& store, UtcTime origin) : store_(store), origin_(toMicroseconds(origin)) {}

    /// Adds an execution with all that it started.
    /// \param parent start of the arrow to it; nullptr: no arrow
    Result<void> add(const ExecutionRow& execution, const ExecutionRow* parent);
    ordered_json events() && { return std::move(events_); }

private:
    struct TraceRow {
        std::size_t process = 0;
        std::size_t thread = 0;
    };
    struct Slice {
        std::string name;
        const char* category;
        std::int64_t from;  // [us since 1970]
        std::int64_t to;
    };

    TraceRow laneOf(const ExecutionRow& execution);
    void nameIt(const char* what, const TraceRow& row, const std::string& name);
    void addSlice(const Slice& slice, const TraceRow& row, ordered_json arguments);
    void addArrow(const ExecutionRow& parent, const ExecutionRow& child);
    Result<std::vector<Transition>> addEvents(const ExecutionRow& execution, std::int64_t& end);
    void addStates(const std::vector<Transition>& transitions, const ExecutionRow& execution,
                   std::int64_t end);

    Store& store_;
    const std::int64_t origin_;
    ordered_json events_ = ordered_json::array();
    std::map<std::string, std::size_t> processes_;
    std::map<std::pair<std::size_t, std::string>, std::size_t> threads_;
    std::set<std::int64_t> known_;
};

Result<void> Trace::add(const ExecutionRow& execution, const ExecutionRow* parent) {
    if (known_.size() >= kMostExecutions || !known_.insert(execution.number).second) {
        return {};
    }
    auto end = toMicroseconds(execution.isOver() ? execution.ended : execution.started);
    METIER_ASSIGN(const auto transitions, addEvents(execution, end));
    METIER_ASSIGN(const auto children, store_.children(execution.number));
    addSlice({execution.skill, "execution", toMicroseconds(execution.started), end},
             laneOf(execution), jsonOf(execution));
    addStates(transitions, execution, end);
    if (parent != nullptr) {
        addArrow(*parent, execution);
    }
    for (const auto& child : children) {
        METIER_TRY(add(child, &execution));
    }
    return {};
}

/// Intermediate results. \param end moved to the last event of an execution under way
Result<std::vector<Transition>> Trace::addEvents(const ExecutionRow& execution, std::int64_t& end) {
    METIER_ASSIGN(auto transitions, store_.transitions(execution.number));
    METIER_ASSIGN(const auto intermediates, store_.intermediates(execution.number));
    const auto row = laneOf(execution);
    for (const auto& one : intermediates) {
        const auto time = toMicroseconds(one.time);
        end = execution.isOver() ? end : std::max(end, time);
        events_.push_back({{"ph", "i"},
                           {"s", "t"},
                           {"name", "intermediate result"},
                           {"cat", "result"},
                           {"ts", time - origin_},
                           {"pid", row.process},
                           {"tid", row.thread},
                           {"args", {{"value", parsed(one.value)}}}});
    }
    for (const auto& one : transitions) {
        end = execution.isOver() ? end : std::max(end, toMicroseconds(one.time));
    }
    return transitions;
}

/// States, and steps within them.
void Trace::addStates(const std::vector<Transition>& transitions, const ExecutionRow& execution,
                      std::int64_t end) {
    const auto row = laneOf(execution);
    const auto within = [&](UtcTime time) {
        return std::clamp(toMicroseconds(time), toMicroseconds(execution.started), end);
    };
    std::optional<Slice> state;
    std::optional<Slice> step;
    const auto close = [&](std::optional<Slice>& slice, std::int64_t time) {
        if (slice && time > slice->from) {
            slice->to = time;
            addSlice(*slice, row, ordered_json::object());
        }
        slice.reset();
    };
    for (const auto& t : transitions) {
        const auto time = within(t.time);
        const bool new_state = !state || state->name != t.to;
        if (new_state || (step ? step->name : std::string()) != t.step) {
            close(step, time);
        }
        if (new_state) {
            close(state, time);
            state = Slice{t.to, "state", time, time};
        }
        if (!step && !t.step.empty()) {
            step = Slice{t.step, "step", time, time};
        }
    }
    close(step, end);
    close(state, end);
}

Trace::TraceRow Trace::laneOf(const ExecutionRow& e) {
    const auto process = processes_.try_emplace(e.server, processes_.size() + 1);
    const auto pid = process.first->second;
    const auto skill = e.controller.empty() ? e.skill : e.controller + "/" + e.skill;
    const auto thread = threads_.try_emplace({pid, skill}, threads_.size() + 1);
    const TraceRow row{pid, thread.first->second};
    if (process.second) {
        nameIt("process_name", row, e.server_name.empty() ? e.server : e.server_name);
    }
    if (thread.second) {
        nameIt("thread_name", row, skill);
    }
    return row;
}

void Trace::nameIt(const char* what, const TraceRow& row, const std::string& name) {
    events_.push_back({{"ph", "M"},
                       {"name", what},
                       {"pid", row.process},
                       {"tid", row.thread},
                       {"args", {{"name", name}}}});
}

void Trace::addSlice(const Slice& slice, const TraceRow& row, ordered_json arguments) {
    events_.push_back({{"ph", "X"},
                       {"name", slice.name},
                       {"cat", slice.category},
                       {"ts", slice.from - origin_},
                       {"dur", slice.to - slice.from},
                       {"pid", row.process},
                       {"tid", row.thread},
                       {"args", std::move(arguments)}});
}

void Trace::addArrow(const ExecutionRow& parent, const ExecutionRow& child) {
    const auto add = [&](const char* phase, const TraceRow& row) -> ordered_json& {
        return events_.emplace_back(
            ordered_json::object({{"ph", phase},
                                  {"name", "starts"},
                                  {"cat", "parent"},
                                  {"id", child.number},
                                  {"ts", toMicroseconds(child.started) - origin_},
                                  {"pid", row.process},
                                  {"tid", row.thread}}));
    };
    add("s", laneOf(parent));
    add("f", laneOf(child))["bp"] = "e";
}

}  // namespace

Result<std::string> chromeTrace(Store& store, std::int64_t number) {
    METIER_ASSIGN(const auto root, store.find(std::to_string(number)));
    Trace trace(store, root.started);
    METIER_TRY(trace.add(root, nullptr));
    ordered_json json{{"traceEvents", std::move(trace).events()},
                      {"displayTimeUnit", "ms"},
                      {"otherData", {{"execution", root.id}, {"started", timeText(root.started)}}}};
    return dump(json);
}

}  // namespace metier::records
