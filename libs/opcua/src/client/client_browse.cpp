// Browse over as many messages as it takes.

#include <memory>
#include <utility>

#include "client/client_requests.hpp"
#include "common/convert.hpp"

namespace metier::opcua {

namespace {

/// Limit for the references of one node; a server that sends more is refused.
constexpr std::size_t kMostReferences = 100'000;

/// One Browse and the BrowseNexts that complete it.
class Browsing : public std::enable_shared_from_this<Browsing> {
public:
    Browsing(ClientCore& core, BrowseQuery query, Deadline deadline,
             Done<std::vector<Reference>> done)
        : core_(core),
          query_(std::move(query)),
          task_{"browsing " + query_.node.toString(), deadline},
          done_(std::move(done)) {}

    void begin();

private:
    void next(UA_ByteString& continuation_point);
    void take(UA_BrowseResult& result);
    template <typename Request>
    OnResponse<Request> taken();
    void finish(Answer<std::vector<Reference>> answer);

    ClientCore& core_;
    const BrowseQuery query_;
    const Task task_;
    const Done<std::vector<Reference>> done_;
    std::vector<Reference> references_;
};

void Browsing::begin() {
    UA_BrowseDescription description{};
    description.nodeId = viewOf(query_.node);
    description.browseDirection = nativeOf(query_.direction);
    description.referenceTypeId = viewOf(query_.reference_type);
    description.includeSubtypes = true;
    description.resultMask = UA_BROWSERESULTMASK_ALL;
    for (const auto node_class : query_.node_classes) {
        description.nodeClassMask |= static_cast<UA_UInt32>(node_class);
    }
    UA_BrowseRequest request{};
    request.requestedMaxReferencesPerNode = query_.references_at_once;
    request.nodesToBrowseSize = 1;
    request.nodesToBrowse = &description;
    core_.send(request, task_, taken<UA_BrowseRequest>());
}

void Browsing::next(UA_ByteString& continuation_point) {
    UA_BrowseNextRequest request{};
    request.continuationPointsSize = 1;
    request.continuationPoints = &continuation_point;
    core_.send(request, task_, taken<UA_BrowseNextRequest>());
}

template <typename Request>
OnResponse<Request> Browsing::taken() {
    return [self = shared_from_this()](auto response) {
        if (!response) {
            self->finish(tl::unexpected(response.error()));
        } else if ((*response)->resultsSize != 1) {
            self->finish(failed(status::kBadUnexpectedError, self->task_.doing));
        } else {
            self->take((*response)->results[0]);
        }
    };
}

void Browsing::take(UA_BrowseResult& result) {
    if (StatusCode(result.statusCode).isBad()) {
        return finish(failed(StatusCode(result.statusCode), task_.doing));
    }
    if (references_.size() + result.referencesSize > kMostReferences) {
        return finish(failed(StatusCode(UA_STATUSCODE_BADENCODINGLIMITSEXCEEDED), task_.doing));
    }
    for (std::size_t i = 0; i < result.referencesSize; ++i) {
        if (result.references[i].nodeId.serverIndex == 0) {
            references_.push_back(fromNative(result.references[i]));
        }
    }
    if (result.continuationPoint.length == 0) {
        return finish(std::move(references_));
    }
    // Sent when the stack has returned from this response.
    core_.later([self = shared_from_this(), point = bytesFrom(result.continuationPoint)]() mutable {
        UA_ByteString view{point.bytes.size(), point.bytes.data()};
        self->next(view);
    });
}

void Browsing::finish(Answer<std::vector<Reference>> answer) {
    core_.later([done = done_, answer = std::move(answer)]() mutable { done(std::move(answer)); });
}

}  // namespace

Answer<> startBrowse(ClientCore& core, BrowseQuery query, Deadline deadline,
                     Done<std::vector<Reference>> done) {
    // Shared by the answers on their way: the last one ends it.
    auto browsing = std::make_shared<Browsing>(core, std::move(query), deadline, std::move(done));
    return core.request([browsing = std::move(browsing)] { browsing->begin(); });
}

}  // namespace metier::opcua
