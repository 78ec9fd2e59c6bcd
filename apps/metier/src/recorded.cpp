#include "recorded.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "metier/base/text.hpp"
#include "metier/server/user_folders.hpp"
#include "robot_argument.hpp"

namespace metier::app {
std::string defaultRecords() {
    const auto folder = server::userStateFolder();
    return folder.empty() ? std::string() : (folder / "records.db").string();
}

CLI::Validator withoutPassword() {
    return {[](const std::string& url) {
                return records::hasPassword(url)
                           ? std::string(
                                 "a password on a command line is shown to everybody on "
                                 "this machine: put it in ~/.pgpass or PGPASSWORD, or the "
                                 "address in the cell's file")
                           : std::string();
            },
            ""};
}

void addRecords(CLI::App& command, std::string& url, const std::string& help) {
    url = defaultRecords();
    command
        .add_option("--records", url,
                    help + ": a file, sqlite:FILE or postgresql://USER@HOST/DATABASE")
        ->check(withoutPassword())
        ->capture_default_str();
}

Result<motion::RobotModel> robotOf(const records::ExecutionRow& execution,
                                   const std::string& named) {
    if (!named.empty()) {
        return loadRobot(named);
    }
    const auto names = inLowerCase(execution.device + " " + execution.server_name);
    std::string best;
    for (const auto& name : robotNames()) {
        auto model = loadRobot(name);
        if (model && !execution.device.empty() && model->product() == execution.device) {
            return model;
        }
        const bool longer = name.size() > best.size();
        best = longer && names.find(inLowerCase(name)) != std::string::npos ? name : best;
    }
    if (best.empty()) {
        return fail(Errc::invalid_argument,
                    fmt::format("execution {}: which robot is device '{}' of server '{}'? Say so "
                                "with --robot: {}",
                                execution.number, execution.device, execution.server_name,
                                fmt::join(robotNames(), ", ")));
    }
    return loadRobot(best);
}

Result<path_evaluation::MotionRecord> pathOf(records::Store& store,
                                             const records::ExecutionRow& execution) {
    METIER_ASSIGN(const auto samples, store.path(execution.number));
    path_evaluation::MotionRecord record;
    for (const auto& sample : samples) {
        const auto values = sample.actual.values();
        const auto position = motion::JointVector::from(values);
        // Two samples of one instant say no more than one.
        if (!position || (!record.empty() && sample.time <= record.back().time)) {
            continue;
        }
        if (!record.empty() && position->size() != record.front().position.size()) {
            return fail(
                Errc::invalid_argument,
                fmt::format("execution {}: {} axes at {:.3f} s, {} before", execution.number,
                            position->size(), sample.time, record.front().position.size()));
        }
        record.push_back({sample.time, *position});
    }
    if (record.size() < path_evaluation::kFewestRecorded) {
        return fail(Errc::not_found,
                    fmt::format("execution {} ({}): {} joint positions were recorded; a drawing "
                                "needs {}",
                                execution.number, execution.skill, record.size(),
                                path_evaluation::kFewestRecorded));
    }
    return record;
}

}  // namespace metier::app
