#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <span>

#include "metier/virtual_iiwa/robot_application.hpp"

namespace {

const metier::motion::RobotModel& model() {
    static const auto kModel =
        metier::motion::RobotModel::load(std::filesystem::path(METIER_MODELS_DIR) / "iiwa7.toml")
            .value();
    return kModel;
}

// A code that exists, so that the arguments behind it are reached.
double knownCode(std::uint8_t choice) {
    constexpr std::array kFirst{101.0, 201.0, 211.0, 221.0, 301.0, 400.0};
    return kFirst[choice % kFirst.size()] + choice / 32;
}

}  // namespace

// Commands of eight numbers, with some cycles of the arm between them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::virtual_iiwa;
    Cabinet cabinet{.arm = Arm(model(), model().home()),
                    .torque_noise = metier::motion::JointVector(7)};
    RobotApplication application(cabinet);
    const auto bytes = std::as_bytes(std::span(data, size));
    const auto length = commandSize(Precision::single_precision);
    for (std::size_t at = 0; at + length <= size; at += length) {
        auto command = decodeCommand(bytes.subspan(at, length), Precision::single_precision);
        if (data[at] % 2 == 0) {
            command.code = knownCode(data[at + 1]);
        }
        application.execute(command);
        const int cycles = data[at + 2] % 8 == 0 ? 20 : 1;
        for (int cycle = 0; cycle < cycles; ++cycle) {
            application.step(cabinet.arm.step());
        }
    }
    for (const double joint : cabinet.arm.position()) {
        if (!std::isfinite(joint)) {
            std::abort();
        }
    }
    encodeState(application.state(), Precision::double_precision);
    return 0;
}
