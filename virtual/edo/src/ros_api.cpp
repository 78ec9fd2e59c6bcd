#include <chrono>
#include <string>
#include <utility>

#include "rosbridge.hpp"

namespace metier::virtual_edo {
namespace {

Json rosTime(UtcTime time) {
    using std::chrono::duration_cast;
    const auto since = time.time_since_epoch();
    const auto seconds = std::chrono::floor<std::chrono::seconds>(since);
    const auto rest = duration_cast<std::chrono::nanoseconds>(since - seconds);
    return Json::object({{"secs", seconds.count()}, {"nsecs", rest.count()}});
}

}  // namespace

void serveRosApi(RosGraph& graph, std::function<UtcTime()> now) {
    const auto serve = [&](const std::string& name, const std::string& type, auto answer) {
        graph.services.emplace(
            "/rosapi/" + name,
            RosGraph::Service{"rosapi/" + type,
                              [answer = std::move(answer)](const Json& arguments) -> Result<Json> {
                                  return answer(arguments);
                              }});
    };
    serve("topics", "Topics", [&graph](const Json&) {
        Json names = Json::array();
        Json types = Json::array();
        for (const auto& [name, type] : graph.topics) {
            names.push_back(name);
            types.push_back(type);
        }
        return Json::object({{"topics", names}, {"types", types}});
    });
    // The type of an unknown topic or service is empty.
    serve("topic_type", "TopicType", [&graph](const Json& arguments) {
        const auto known = graph.topics.find(arguments["topic"].get<std::string>());
        return Json::object({{"type", known == graph.topics.end() ? "" : known->second}});
    });
    serve("topics_for_type", "TopicsForType", [&graph](const Json& arguments) {
        Json names = Json::array();
        for (const auto& [name, type] : graph.topics) {
            if (type == arguments["type"].get<std::string>()) {
                names.push_back(name);
            }
        }
        return Json::object({{"topics", names}});
    });
    serve("services", "Services", [&graph](const Json&) {
        Json names = Json::array();
        for (const auto& [name, service] : graph.services) {
            names.push_back(name);
        }
        return Json::object({{"services", names}});
    });
    serve("service_type", "ServiceType", [&graph](const Json& arguments) {
        const auto known = graph.services.find(arguments["service"].get<std::string>());
        return Json::object({{"type", known == graph.services.end() ? "" : known->second.type}});
    });
    serve("get_time", "GetTime", [now = std::move(now)](const Json&) {
        return Json::object({{"time", rosTime(now())}});
    });
}

}  // namespace metier::virtual_edo
