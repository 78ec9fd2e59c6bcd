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

Recorder::Key Recorder::begin(const ExecutionView& execution) {
    return impl_->begin(execution);
}

Recorder::Key Recorder::begin(const ExecutionView& execution, const TransitionView& first) {
    return impl_->begin(execution, first);
}

void Recorder::transition(Key key, const TransitionView& transition) {
    impl_->tell(key, transition);
}

void Recorder::intermediate(Key key, const IntermediateView& intermediate) {
    impl_->tell(key, intermediate);
}

void Recorder::sample(Key key, const PathSample& sample) noexcept {
    impl_->sample({key, sample});
}

void Recorder::end(Key key, const OutcomeView& outcome) {
    impl_->end(key, outcome);
}

void Recorder::end(Key key, const OutcomeView& outcome, const TransitionView& last) {
    impl_->end(key, last, outcome);
}

void Recorder::record(const WholeExecution& whole) {
    impl_->begin(whole);
}

bool Recorder::flush(SteadyTime deadline) {
    return impl_->flush(deadline);
}

Recorder::Status Recorder::status() const {
    return impl_->status();
}

}  // namespace metier::records
