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

Recorder::Key Recorder::begin(const Execution& execution, ToJson to_json) {
    return impl_->begin(execution, to_json);
}

void Recorder::transition(Key key, const Transition& transition) {
    impl_->tell(key, transition);
}

void Recorder::intermediate(Key key, const Intermediate& intermediate) {
    impl_->tell(key, intermediate);
}

void Recorder::sample(Key key, const PathSample& sample) noexcept {
    impl_->sample({key, sample});
}

void Recorder::end(Key key, const Outcome& outcome) {
    impl_->end(key, outcome);
}

bool Recorder::flush(SteadyTime deadline) {
    return impl_->flush(deadline);
}

Recorder::Status Recorder::status() const {
    return impl_->status();
}

}  // namespace metier::records
