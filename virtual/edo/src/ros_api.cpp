#include "ros_api.hpp"

#include <chrono>
#include <string>
#include <utility>

namespace metier::virtual_edo {
namespace {

Json topicsAndTypes(const RosGraph& graph) {
    Json names = Json::array();
    Json types = Json::array();
    for (const auto& [name, type] : graph.topics) {
        names.push_back(name);
        types.push_back(type);
    }
    return Json::object({{"topics", names}, {"types", types}});
}

/// Nothing is known of a topic: the type is empty.
Json topicType(const RosGraph& graph, const std::string& topic) {
    const auto known = graph.topics.find(topic);
    return Json::object({{"type", known == graph.topics.end() ? "" : known->second}});
}

Json topicsForType(const RosGraph& graph, const std::string& wanted) {
    Json names = Json::array();
    for (const auto& [name, type] : graph.topics) {
        if (type == wanted) {
            names.push_back(name);
        }
    }
    return Json::object({{"topics", names}});
}

Json services(const RosGraph& graph) {
    Json names = Json::array();
    for (const auto& [name, service] : graph.services) {
        names.push_back(name);
    }
    return Json::object({{"services", names}});
}

Json serviceType(const RosGraph& graph, const std::string& service) {
    const auto known = graph.services.find(service);
    return Json::object({{"type", known == graph.services.end() ? "" : known->second.type}});
}

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
    serve("topics", "Topics", [&graph](const Json&) { return topicsAndTypes(graph); });
    serve("topic_type", "TopicType", [&graph](const Json& arguments) {
        return topicType(graph, arguments["topic"].get<std::string>());
    });
    serve("topics_for_type", "TopicsForType", [&graph](const Json& arguments) {
        return topicsForType(graph, arguments["type"].get<std::string>());
    });
    serve("services", "Services", [&graph](const Json&) { return services(graph); });
    serve("service_type", "ServiceType", [&graph](const Json& arguments) {
        return serviceType(graph, arguments["service"].get<std::string>());
    });
    serve("get_time", "GetTime", [now = std::move(now)](const Json&) {
        return Json::object({{"time", rosTime(now())}});
    });
}

}  // namespace metier::virtual_edo
