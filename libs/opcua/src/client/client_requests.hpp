#pragma once

#include <functional>
#include <string>
#include <vector>

#include "client/client_core.hpp"

namespace metier::opcua {

/// Hears the outcome of a request once, on the client's thread while the stack is not at work.
template <typename T = void>
using Done = std::function<void(Answer<T>)>;

// Each sends a request from any thread and does not wait.
// Errors: connection_lost, here and at once: then `done` is not called.

Answer<> startRead(ClientCore& core, std::vector<ReadItem> items, Deadline deadline,
                   Done<std::vector<DataValue>> done);
Answer<> startWrite(ClientCore& core, std::vector<WriteItem> items, Deadline deadline,
                    Done<std::vector<StatusCode>> done);
Answer<> startCall(ClientCore& core, MethodCall call, Deadline deadline, Done<CallResult> done);
Answer<> startBrowse(ClientCore& core, BrowseQuery query, Deadline deadline,
                     Done<std::vector<Reference>> done);
Answer<> startTranslate(ClientCore& core, std::vector<RelativePath> paths, Deadline deadline,
                        Done<std::vector<Answer<NodeId>>> done);

}  // namespace metier::opcua
