// metier_compare_urdfs [FILE.urdf[:BASE:TIP] | FOLDER]...
//
// Imports each file and compares the model's forward kinematics with KDL's chain of the same file
// over 1,000 random joint positions, the model after an export and a second import with the first,
// and solves the inverse kinematics of 200 random poses and plans straight lines from 50 of them. A
// file that cannot be taken in is listed with the reason. Missing velocities count as 1 rad/s,
// missing ranges as +-pi. Exit status 1 if a position differs by more than 1e-9 m or a rotation by
// more than 1e-9 rad.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "comparison.hpp"
#include "metier/base/text.hpp"
#include "metier/motion/planner.hpp"
#include "metier/robot_files/export.hpp"
#include "metier/robot_files/import.hpp"

namespace metier::robot_files {
namespace {

namespace fs = std::filesystem;

constexpr double kMost = 1e-9;  // [m], [rad]
constexpr int kPositions = 1000;
constexpr int kPoses = 200;
constexpr int kLines = 50;

struct Asked {
    fs::path file;
    ImportOptions options;
};

std::string textOf(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

Asked askedFor(std::string_view argument) {
    const auto parts = split(argument, ':');
    Asked asked{fs::path(parts[0]), {}};
    asked.options.velocity = {1.0};
    asked.options.position = {-3.14159, 3.14159};
    asked.options.base = parts.size() > 1 ? parts[1] : "";
    asked.options.tip = parts.size() > 2 ? parts[2] : "";
    return asked;
}

std::vector<Asked> filesOf(int argc, char** argv) {
    std::vector<Asked> files;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (!fs::is_directory(argument)) {
            files.push_back(askedFor(argument));
            continue;
        }
        std::set<std::string> found;
        for (const auto& entry : fs::recursive_directory_iterator(argument)) {
            if (entry.path().extension() == ".urdf") {
                found.insert(entry.path().string());
            }
        }
        for (const auto& file : found) {
            files.push_back(askedFor(file));
        }
    }
    return files;
}

struct Share {
    int done = 0;
    int of = 0;
    double milliseconds = 0;
};

template <typename Work>
Share shareOf(int count, Work work) {
    Share share{0, count};
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < count; ++i) {
        share.done += work() ? 1 : 0;
    }
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    share.milliseconds = took.count() / count;
    return share;
}

Share solved(const motion::RobotModel& model) {
    std::mt19937_64 random(2);
    return shareOf(kPoses, [&] {
        const auto pose = model.kinematics().forward(allowedPosition(model, random));
        return model.kinematics().inverse(pose, {model.home(), {}, {}}).has_value();
    });
}

/// Straight lines of 5 cm along the base's x axis from random positions near home.
Share planned(const motion::RobotModel& model) {
    std::mt19937_64 random(3);
    const motion::Planner planner(model);
    return shareOf(kLines, [&] {
        const auto somewhere = allowedPosition(model, random);
        motion::LinRequest request;
        request.start = model.home();
        for (std::size_t i = 0; i < request.start.size(); ++i) {
            request.start[i] += 0.2 * (somewhere[i] - request.start[i]);
        }
        request.target = model.kinematics().forward(request.start);
        request.target.translation.x() += 0.05;
        return planner.lin(request).has_value();
    });
}

const char* methodOf(const motion::RobotModel& model) {
    switch (model.kinematics().ikKind()) {
        case motion::IkKind::three_parallel_axes:
            return model.kinematics().isCalibrated() ? "parallel*" : "parallel";
        case motion::IkKind::spherical_wrist:
            return "wrist";
        case motion::IkKind::arm_angle:
            return "arm angle";
        case motion::IkKind::numeric:
            break;
    }
    return "iteration";
}

/// The model after an export and an import.
Result<ImportedRobot> again(const ImportedRobot& first) {
    const auto exported = exportUrdf(first.model);
    return importUrdf({"again.urdf", exported.urdf}, SourceFile{"again.srdf", exported.srdf}, {});
}

PoseDifference differenceOf(const motion::RobotModel& one, const motion::RobotModel& other) {
    std::mt19937_64 random(4);
    PoseDifference most;
    for (int i = 0; i < kPositions; ++i) {
        const auto q = anyPosition(one.axisCount(), random);
        const auto a = one.kinematics().forward(q);
        const auto b = other.kinematics().forward(q);
        most.position = std::max(most.position, motion::distanceBetween(a, b));
        most.rotation =
            std::max(most.rotation, 2 * (a.rotation.conjugate() * b.rotation).vec().norm());
    }
    return most;
}

/// \return whether the file was refused or gave the same kinematics
bool compare(const Asked& asked) {
    const auto text = textOf(asked.file);
    const auto imported = importUrdf({asked.file.string(), text}, std::nullopt, asked.options);
    const auto name = asked.file.filename().string();
    if (!imported) {
        fmt::print("{:<26} refused: {}\n", name, imported.error().message);
        return true;
    }
    KdlUrdf kdl(text, imported->base, imported->tip);
    const auto difference = differenceToKdl(imported->model, kdl, kPositions);
    const auto second = again(*imported);
    const auto back = second ? differenceOf(imported->model, second->model) : PoseDifference{1, 1};
    const auto ik = solved(imported->model);
    const auto lines = planned(imported->model);
    fmt::print("{:<26} {} {:<9} {:.1e} {:.1e} {:.1e} {:3}/{} {:7.3f} {:2}/{} {:6.2f} {} - {}\n",
               name, imported->model.axisCount(), methodOf(imported->model), difference.position,
               difference.rotation, std::max(back.position, back.rotation), ik.done, ik.of,
               ik.milliseconds, lines.done, lines.of, lines.milliseconds, imported->base,
               imported->tip);
    return std::max({difference.position, difference.rotation, back.position, back.rotation}) <
           kMost;
}

int run(int argc, char** argv) {
    bool good = argc > 1;
    fmt::print(
        "file                  axes by        fk/m    fk/rad  again   solved  ms/pose lines "
        "ms/line base - tip\n");
    for (const auto& asked : filesOf(argc, argv)) {
        good = compare(asked) && good;
    }
    return good ? 0 : 1;
}

}  // namespace
}  // namespace metier::robot_files

int main(int argc, char** argv) {
    try {
        return metier::robot_files::run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "metier_compare_urdfs: {}\n", error.what());
        return 1;
    }
}
