#include "metier/records/recorder.hpp"

#include <utility>

#include "recorder_threads.hpp"

namespace metier::records {

Result<std::unique_ptr<Recorder>> Recorder::create(Options options) {
    if (auto known = checkUrl(options.url); !known) {
        return fail(known.error());
    }
    if (options.server.empty()) {
        return fail(Errc::invalid_argument, "who records must name its server");
    }
    return std::unique_ptr<Recorder>(new Recorder(std::make_unique<Impl>(std::move(options))));
}

Recorder::Recorder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Recorder::~Recorder() = default;

Recorder::Key Recorder::begin(Execution execution, Completion complete) {
    return impl_->begin(std::make_unique<Begun>(Begun{std::move(execution), std::move(complete)}));
}

void Recorder::transition(Key key, Transition transition) {
    impl_->tell({key, std::move(transition)});
}

void Recorder::intermediate(Key key, Intermediate intermediate) {
    impl_->tell({key, std::move(intermediate)});
}

void Recorder::sample(Key key, const PathSample& sample) noexcept {
    impl_->sample({key, sample});
}

void Recorder::end(Key key, Outcome outcome) {
    impl_->end({key, std::move(outcome)});
}

bool Recorder::flush(SteadyTime deadline) {
    return impl_->flush(deadline);
}

Recorder::Status Recorder::status() const {
    return impl_->status();
}

}  // namespace metier::records
