// A camera that looks for a part, with one skill: CaptureImageSkill. It sees a part in each image
// but every third.
#include <chrono>
#include <memory>
#include <utility>

#include "metier/server/own_server.hpp"

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

}  // namespace
}  // namespace metier::example

int main(int argc, char** argv) {
    using namespace metier;
    server::OwnServer own(argc, argv,
                          {.name = "camera",
                           .description = "A camera over the conveyor.",
                           .types = "urn:example:camera",
                           .port = 48463});
    example::Camera camera(own.executor());
    own.offer(example::captureImage(),
              {.start =
                   [&camera](const auto& values, const auto& execution) {
                       camera.capture(std::get<double>(values.at("ExposureTime")), execution);
                   },
               .halt =
                   [&camera](const auto& execution) {
                       camera.stop();
                       execution.atRest();
                   }},
              {.terms = {"inspect"}});
    return own.run();
}
