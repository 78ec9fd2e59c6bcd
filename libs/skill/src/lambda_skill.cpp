#include "metier/skill/lambda_skill.hpp"

#include <utility>

namespace metier::skill {

namespace {

class LambdaWork final : public ExecutionWork {
public:
    /// \param functions must outlive the work
    LambdaWork(const SkillFunctions& functions, ValueMap parameters)
        : functions_(functions), parameters_(std::move(parameters)) {}

    void start(ExecutionHandle execution) override {
        execution_ = std::move(execution);
        if (functions_.start) {
            functions_.start(parameters_, execution_);
        } else {
            execution_.finish();
        }
    }
    Result<void> suspend() override { return functions_.suspend(execution_); }
    Result<void> resume() override { return functions_.resume(execution_); }
    void halt() override {
        if (functions_.halt) {
            functions_.halt(execution_);
        } else {
            execution_.atRest();
        }
    }
    void forceStop() noexcept override {
        if (functions_.force_stop) {
            functions_.force_stop();
        }
    }

private:
    const SkillFunctions& functions_;
    const ValueMap parameters_;
    ExecutionHandle execution_;
};

}  // namespace

LambdaSkill::LambdaSkill(SkillDescription description, SkillFunctions functions)
    : description_(std::move(description)), functions_(std::move(functions)) {
    description_.suspendable = functions_.suspend && functions_.resume;
}

Result<std::unique_ptr<ExecutionWork>> LambdaSkill::prepare(const ValueMap& snapshot) {
    if (functions_.check) {
        METIER_TRY(functions_.check(snapshot));
    }
    return std::make_unique<LambdaWork>(functions_, snapshot);
}

Result<void> LambdaSkill::reset() {
    return functions_.reset ? functions_.reset() : Result<void>{};
}

}  // namespace metier::skill
