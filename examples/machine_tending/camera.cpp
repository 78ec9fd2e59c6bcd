// A camera that looks for a part, with one skill: CaptureImageSkill. It sees a part in each image
// but every third.
#include <chrono>
#include <memory>
#include <utility>

#include "metier/skill/lambda_skill.hpp"
#include "skill_program.hpp"

namespace metier::example {
namespace {

using skill::ExecutionHandle;
using skill::ValueMap;
using skill::ValueType;

/// The camera. Threading: that of its executor.
class Camera {
public:
    explicit Camera(std::shared_ptr<skill::Executor> executor) : executor_(std::move(executor)) {}

    void capture(double exposure_s, const ExecutionHandle& execution) {
        exposure_ = executor_->after(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                         std::chrono::duration<double>(exposure_s)),
                                     [this, execution] { execution.finish(look()); });
    }
    void stop() { exposure_.cancel(); }

private:
    ValueMap look() {
        const bool found = ++images_ % 3 != 0;
        const skill::Frame part{0.5, 0.1, 0.3, 3.14159, 0.0, 3.14159};
        return {{"PartFound", found}, {"PartPose", found ? skill::Value(part) : skill::Value()}};
    }

    std::shared_ptr<skill::Executor> executor_;
    skill::Timer exposure_;
    unsigned images_ = 0;
};

skill::SkillDescription captureImage() {
    return {.name = "CaptureImageSkill",
            .type = "CaptureImageSkillType",
            .description = "Takes an image and looks for a part in it.",
            .parameters = {{.name = "ExposureTime",
                            .description = "Time that the sensor is exposed.",
                            .type = ValueType::number,
                            .unit = skill::kSecond,
                            .range = skill::Range{0.0001, 1.0},
                            .default_value = 0.02}},
            .results = {{.name = "PartFound",
                         .description = "Whether a part is in the image.",
                         .type = ValueType::boolean,
                         .place = skill::Place::final_result},
                        {.name = "PartPose",
                         .description = "Where to grasp it, in the base frame of the arm.",
                         .type = ValueType::frame,
                         .place = skill::Place::final_result}}};
}

std::vector<Offered> skillsOf(std::shared_ptr<skill::Executor> executor) {
    const auto camera = std::make_shared<Camera>(std::move(executor));
    std::vector<Offered> offered;
    offered.push_back(
        {std::make_unique<skill::LambdaSkill>(
             captureImage(),
             skill::SkillFunctions{
                 .start =
                     [camera](const ValueMap& values, const ExecutionHandle& execution) {
                         camera->capture(std::get<double>(values.at("ExposureTime")), execution);
                     },
                 .halt =
                     [camera](const ExecutionHandle& execution) {
                         camera->stop();
                         execution.atRest();
                     }}),
         {"inspect"}});
    return offered;
}

}  // namespace
}  // namespace metier::example

int main(int argc, char** argv) {
    using namespace metier::example;
    return serve({"camera", "A camera over the conveyor.", "urn:example:camera", skillsOf}, argc,
                 argv);
}
