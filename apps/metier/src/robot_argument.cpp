#include "robot_argument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

namespace metier::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtension = ".toml";

/// Folder of the models: of the installed program, else of the source tree from which it was built.
fs::path modelsFolder() {
    return sharedFolder("models", METIER_MODELS_DIR);
}

bool isFile(const std::string& robot) {
    return robot.find('/') != std::string::npos || robot.ends_with(kExtension);
}

std::vector<std::string> namesIn(const fs::path& folder) {
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        if (entry.path().extension() == kExtension) {
            names.push_back(entry.path().stem().string());
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace

fs::path sharedFolder(const char* name, const char* otherwise) {
    std::error_code error;
    const auto program = fs::read_symlink("/proc/self/exe", error);
    const auto installed = program.parent_path().parent_path() / "share" / "metier" / name;
    return !error && fs::is_directory(installed, error) ? installed : fs::path(otherwise);
}

void addRobot(CLI::App& command, std::string& robot) {
    command
        .add_option("robot", robot,
                    "Which robot: ur5, ur5e, iiwa7, iiwa14, edo, or the file of a model")
        ->required();
}

std::vector<std::string> robotNames() {
    return namesIn(modelsFolder());
}

bool isRobot(const std::string& robot) {
    const auto names = robotNames();
    return isFile(robot) || std::find(names.begin(), names.end(), robot) != names.end();
}

Result<motion::RobotModel> loadRobot(const std::string& robot) {
    if (isFile(robot)) {
        return motion::RobotModel::load(robot);
    }
    const auto folder = modelsFolder();
    const auto names = namesIn(folder);
    if (std::find(names.begin(), names.end(), robot) == names.end()) {
        return fail(Errc::invalid_argument,
                    names.empty()
                        ? fmt::format("no robot '{}': no models in {}", robot, folder.string())
                        : fmt::format("no robot '{}'; there are: {}, or the file of a model", robot,
                                      fmt::join(names, ", ")));
    }
    return motion::RobotModel::load(folder / (robot + std::string(kExtension)));
}

Result<std::vector<motion::RobotModel>> loadAllRobots() {
    std::vector<motion::RobotModel> models;
    for (const auto& name : namesIn(modelsFolder())) {
        METIER_ASSIGN(auto model, loadRobot(name));
        models.push_back(std::move(model));
    }
    return models;
}

}  // namespace metier::app
