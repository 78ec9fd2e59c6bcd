#include "client/client_requests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/native.hpp"

namespace metier::opcua {

namespace {

std::string doingToAll(std::string_view verb, std::size_t count, const NodeId& first) {
    return count == 1 ? fmt::format("{} {}", verb, first.toString())
                      : fmt::format("{} {} nodes, {} first", verb, count, first.toString());
}

/// A peer that answers another number of items than it was asked for cannot be understood.
Failure miscounted(const std::string& doing, std::size_t answered, std::size_t asked) {
    return {{Errc::internal, fmt::format("{}: {} answers to {} items", doing, answered, asked)},
            status::kBadUnexpectedError,
            {}};
}

/// Passes the result of `convert` for a response, or the reason why there is none, to `done` when
/// the stack is not at work.
template <typename Request, typename T, typename Convert>
OnResponse<Request> converted(ClientCore& core, Done<T> done, Convert convert) {
    using Response = typename Service<Request>::Response;
    return [&core, done = std::move(done), convert = std::move(convert)](Answer<Response*> answer) {
        core.later([done, result = answer ? convert(**answer)
                                          : Answer<T>(tl::unexpected(answer.error()))]() mutable {
            done(std::move(result));
        });
    };
}

UA_ReadValueId nativeOf(const ReadItem& item) {
    UA_ReadValueId native{};
    native.nodeId = viewOf(item.node);
    native.attributeId = static_cast<UA_UInt32>(item.attribute);
    return native;
}

UA_WriteValue nativeOf(const WriteItem& item) {
    UA_WriteValue native{};
    native.nodeId = viewOf(item.node);
    native.attributeId = UA_ATTRIBUTEID_VALUE;
    native.value.hasValue = true;
    native.value.value = ValueAccess::native(item.value);
    if (item.source_time) {
        native.value.hasSourceTimestamp = true;
        native.value.sourceTimestamp = nativeTime(*item.source_time);
    }
    return native;
}

UA_BrowsePath nativeOf(const NodeId& start, std::vector<UA_RelativePathElement>& elements) {
    UA_BrowsePath native{};
    native.startingNode = viewOf(start);
    native.relativePath = {elements.size(), elements.data()};
    return native;
}

std::vector<UA_RelativePathElement> elementsOf(const RelativePath& path) {
    std::vector<UA_RelativePathElement> elements;
    for (const auto& name : path.names) {
        elements.push_back({viewOf(ids::kHierarchicalReferences), false, true, viewOf(name)});
    }
    return elements;
}

/// NodeIds of another run of the server may name something else by now.
Answer<> checkBoot(const ClientCore& core, std::uint64_t boot, const std::string& doing) {
    if (boot == 0 || boot == core.boot()) {
        return {};
    }
    return tl::unexpected(
        Failure{{Errc::invalid_state,
                 doing + ": not sent, the server was started again since its node was looked up"},
                status::kBadInvalidState,
                {},
                Failure::Delivery::not_sent});
}

template <typename T>
void refuse(ClientCore& core, const Done<T>& done, const Failure& failure) {
    core.later([done, failure] { done(tl::unexpected(failure)); });
}

template <typename Native, typename Items>
std::vector<Native> nativesOf(const Items& items) {
    std::vector<Native> natives;
    natives.reserve(items.size());
    for (const auto& item : items) {
        natives.push_back(nativeOf(item));
    }
    return natives;
}

void sendRead(ClientCore& core, const std::vector<ReadItem>& items, Task task,
              Done<std::vector<DataValue>> done) {
    auto natives = nativesOf<UA_ReadValueId>(items);
    UA_ReadRequest request{};
    request.timestampsToReturn = UA_TIMESTAMPSTORETURN_BOTH;
    request.nodesToReadSize = natives.size();
    request.nodesToRead = natives.data();
    auto convert = [doing = task.doing, asked = natives.size()](
                       UA_ReadResponse& response) -> Answer<std::vector<DataValue>> {
        if (response.resultsSize != asked) {
            return tl::unexpected(miscounted(doing, response.resultsSize, asked));
        }
        std::vector<DataValue> values;
        values.reserve(asked);
        std::transform(response.results, response.results + asked, std::back_inserter(values),
                       [](const UA_DataValue& value) { return fromNative(value); });
        return values;
    };
    core.send(request, std::move(task),
              converted<UA_ReadRequest>(core, std::move(done), std::move(convert)));
}

void sendWrite(ClientCore& core, const std::vector<WriteItem>& items, Task task,
               Done<std::vector<StatusCode>> done) {
    for (const auto& item : items) {
        if (const auto current = checkBoot(core, item.boot, task.doing); !current) {
            return refuse(core, done, current.error());
        }
    }
    auto natives = nativesOf<UA_WriteValue>(items);
    UA_WriteRequest request{};
    request.nodesToWriteSize = natives.size();
    request.nodesToWrite = natives.data();
    auto convert = [doing = task.doing, asked = natives.size()](
                       UA_WriteResponse& response) -> Answer<std::vector<StatusCode>> {
        if (response.resultsSize != asked) {
            return tl::unexpected(miscounted(doing, response.resultsSize, asked));
        }
        return vectorFrom<StatusCode>(response.results, asked);
    };
    core.send(request, std::move(task),
              converted<UA_WriteRequest>(core, std::move(done), std::move(convert)));
}

Failure refusedCall(const std::string& doing, const UA_CallMethodResult& result) {
    const StatusCode status(result.statusCode);
    Failure failure{
        errorFrom(status, doing), status,
        vectorFrom<StatusCode>(result.inputArgumentResults, result.inputArgumentResultsSize)};
    for (std::size_t i = 0; i < failure.input_results.size(); ++i) {
        if (failure.input_results[i].isBad()) {
            failure.message +=
                fmt::format(", argument {}: {}", i + 1, failure.input_results[i].name());
        }
    }
    return failure;
}

Answer<CallResult> callResultFrom(const std::string& doing, UA_CallResponse& response) {
    if (response.resultsSize != 1) {
        return tl::unexpected(miscounted(doing, response.resultsSize, 1));
    }
    auto& native = response.results[0];
    if (StatusCode(native.statusCode).isBad()) {
        return tl::unexpected(refusedCall(doing, native));
    }
    CallResult result{
        StatusCode(native.statusCode),
        vectorFrom<StatusCode>(native.inputArgumentResults, native.inputArgumentResultsSize),
        {}};
    for (std::size_t i = 0; i < native.outputArgumentsSize; ++i) {
        result.outputs.push_back(ValueAccess::take(native.outputArguments[i]));
    }
    return result;
}

void sendCall(ClientCore& core, const MethodCall& call, Task task, Done<CallResult> done) {
    if (const auto current = checkBoot(core, call.boot, task.doing); !current) {
        return refuse(core, done, current.error());
    }
    std::vector<UA_Variant> inputs;
    inputs.reserve(call.inputs.size());
    for (const auto& input : call.inputs) {
        inputs.push_back(ValueAccess::native(input));
    }
    UA_CallMethodRequest native{};
    native.objectId = viewOf(call.object);
    native.methodId = viewOf(call.method);
    native.inputArgumentsSize = inputs.size();
    native.inputArguments = inputs.data();
    UA_CallRequest request{};
    request.methodsToCallSize = 1;
    request.methodsToCall = &native;
    auto convert = [doing = task.doing](UA_CallResponse& response) {
        return callResultFrom(doing, response);
    };
    core.send(request, std::move(task),
              converted<UA_CallRequest>(core, std::move(done), std::move(convert)));
}

Answer<NodeId> targetFrom(const RelativePath& path, const UA_BrowsePathResult& result) {
    const auto doing = [&path] {
        return "the path " + path.start.toString() + (path.names.empty() ? "" : "/") +
               textOf(path.names);
    };
    if (StatusCode(result.statusCode).isBad()) {
        return failed(StatusCode(result.statusCode), doing());
    }
    const auto* first = result.targets;
    const auto* last = first + result.targetsSize;
    const auto* found = std::find_if(first, last, [](const UA_BrowsePathTarget& target) {
        return target.remainingPathIndex == UA_UINT32_MAX && target.targetId.serverIndex == 0;
    });
    if (found == last) {
        return failed(status::kBadNoMatch, doing());
    }
    return fromNative(found->targetId.nodeId);
}

void sendTranslate(ClientCore& core, const std::vector<RelativePath>& paths, Task task,
                   Done<std::vector<Answer<NodeId>>> done) {
    std::vector<std::vector<UA_RelativePathElement>> elements;
    std::vector<UA_BrowsePath> natives;
    for (const auto& path : paths) {
        natives.push_back(nativeOf(path.start, elements.emplace_back(elementsOf(path))));
    }
    UA_TranslateBrowsePathsToNodeIdsRequest request{};
    request.browsePathsSize = natives.size();
    request.browsePaths = natives.data();
    auto convert = [doing = task.doing, paths](UA_TranslateBrowsePathsToNodeIdsResponse& response)
        -> Answer<std::vector<Answer<NodeId>>> {
        if (response.resultsSize != paths.size()) {
            return tl::unexpected(miscounted(doing, response.resultsSize, paths.size()));
        }
        std::vector<Answer<NodeId>> targets;
        for (std::size_t i = 0; i < paths.size(); ++i) {
            targets.push_back(targetFrom(paths[i], response.results[i]));
        }
        return targets;
    };
    core.send(request, std::move(task),
              converted<UA_TranslateBrowsePathsToNodeIdsRequest>(core, std::move(done),
                                                                 std::move(convert)));
}

}  // namespace

Answer<> startRead(ClientCore& core, std::vector<ReadItem> items, Deadline deadline,
                   Done<std::vector<DataValue>> done) {
    return core.request([&core, items = std::move(items), deadline, done = std::move(done)] {
        const auto first = items.empty() ? NodeId() : items.front().node;
        sendRead(core, items, {doingToAll("reading", items.size(), first), deadline}, done);
    });
}

Answer<> startWrite(ClientCore& core, std::vector<WriteItem> items, Deadline deadline,
                    Done<std::vector<StatusCode>> done) {
    return core.request([&core, items = std::move(items), deadline, done = std::move(done)] {
        const auto first = items.empty() ? NodeId() : items.front().node;
        sendWrite(core, items,
                  {doingToAll("writing", items.size(), first), deadline, Effect::commands}, done);
    });
}

Answer<> startCall(ClientCore& core, MethodCall call, Deadline deadline, Done<CallResult> done) {
    return core.request([&core, call = std::move(call), deadline, done = std::move(done)] {
        sendCall(core, call, {"calling " + call.method.toString(), deadline, Effect::commands},
                 done);
    });
}

Answer<> startTranslate(ClientCore& core, std::vector<RelativePath> paths, Deadline deadline,
                        Done<std::vector<Answer<NodeId>>> done) {
    return core.request([&core, paths = std::move(paths), deadline, done = std::move(done)] {
        const auto first = paths.empty() ? NodeId() : paths.front().start;
        sendTranslate(core, paths,
                      {doingToAll("following paths from", paths.size(), first), deadline}, done);
    });
}

}  // namespace metier::opcua
