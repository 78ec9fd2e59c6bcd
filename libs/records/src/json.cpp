#include "metier/records/json.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <concepts>

#include "json_text.hpp"
#include "metier/records/members.hpp"

namespace metier::records {
namespace {

using nlohmann::ordered_json;

ordered_json valueOf(const Member& member, const std::string& text) {
    return member.form == Form::json ? parsed(text) : ordered_json(text);
}
ordered_json valueOf(const Member& /*member*/, UtcTime time) {
    return time == UtcTime{} ? ordered_json() : ordered_json(timeText(time));
}
template <std::integral T>
ordered_json valueOf(const Member& /*member*/, T number) {
    return number;
}

ordered_json durationOf(const ExecutionRow& execution) {
    const std::chrono::duration<double> duration = execution.ended - execution.started;
    return execution.isOver() ? ordered_json(duration.count()) : ordered_json();
}

/// An object with the members.
template <typename Record>
ordered_json jsonOf(const Record& record) {
    auto json = ordered_json::object();
    visitMembers(record, [&json](const Member& member, const auto& value) {
        json[std::string(member.name)] = valueOf(member, value);
    });
    return json;
}

ordered_json jsonOf(const PathSample& sample) {
    ordered_json json{{"time", sample.time}, {"actual", sample.actual.values()}};
    if (!sample.commanded.empty()) {
        json["commanded"] = sample.commanded.values();
    }
    if (!sample.force.empty()) {
        json["force"] = sample.force.values();
    }
    return json;
}

template <typename T>
ordered_json listOf(const std::vector<T>& all) {
    auto list = ordered_json::array();
    for (const auto& one : all) {
        list.push_back(jsonOf(one));
    }
    return list;
}

}  // namespace

std::string timeText(UtcTime time) {
    if (time == UtcTime{}) {
        return {};
    }
    const auto milliseconds = std::chrono::floor<std::chrono::milliseconds>(time);
    const auto seconds = std::chrono::floor<std::chrono::seconds>(milliseconds);
    return fmt::format("{:%FT%T}.{:03}Z",
                       fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)),
                       (milliseconds - seconds).count());
}

ordered_json parsed(const std::string& text) {
    if (text.empty()) {
        return nullptr;
    }
    auto json = ordered_json::parse(text, nullptr, false);
    return json.is_discarded() ? ordered_json(text) : json;
}

std::string dump(const ordered_json& json) {
    return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json jsonOf(const ExecutionRow& execution) {
    auto json = ordered_json::object();
    visitMembers(execution, [&](const Member& member, const auto& value) {
        json[std::string(member.name)] = valueOf(member, value);
        if (member.name == "ended") {
            json["duration"] = durationOf(execution);
        }
    });
    return json;
}

std::string toJson(const ExecutionRow& execution) {
    return dump(jsonOf(execution));
}

std::string toJson(const Details& details) {
    auto json = jsonOf(details.execution);
    json["transitions"] = listOf(details.transitions);
    json["intermediates"] = listOf(details.intermediates);
    json["children"] = listOf(details.children);
    json["path"] = listOf(details.path);
    return dump(json);
}

Result<Details> detailsOf(Store& store, std::int64_t number) {
    METIER_ASSIGN(auto execution, store.find(std::to_string(number)));
    METIER_ASSIGN(auto children, store.children(number));
    METIER_ASSIGN(auto transitions, store.transitions(number));
    METIER_ASSIGN(auto intermediates, store.intermediates(number));
    METIER_ASSIGN(auto path, store.path(number));
    return Details{std::move(execution), std::move(children), std::move(transitions),
                   std::move(intermediates), std::move(path)};
}

}  // namespace metier::records
