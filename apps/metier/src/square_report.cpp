#include "square_report.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "metier/base/numbers.hpp"

namespace metier::app {
namespace {

std::string rowOf(const SquareOutcome& outcome) {
    if (!outcome.result) {
        return fmt::format("{:<14} failed: {}\n", outcome.name, outcome.result.error().message);
    }
    const auto& result = *outcome.result;
    const auto& measured = result.path.measurement;
    return fmt::format("{:<14} {:>4} {:>8.2f} {:>14.4f} {:>12.4f} {:>8}\n", outcome.name,
                       result.laps, result.time.count(),
                       measured.largest_deviation * kMillimetresPerMetre,
                       measured.closure_error * kMillimetresPerMetre, result.missed_cycles);
}

nlohmann::json jsonOf(const SquareOutcome& outcome) {
    nlohmann::json json{{"arm", outcome.name}, {"url", outcome.url}};
    if (!outcome.result) {
        json["error"] = outcome.result.error().message;
        return json;
    }
    const auto& result = *outcome.result;
    const auto& measured = result.path.measurement;
    json["laps"] = result.laps;
    json["time_s"] = result.time.count();
    json["deviation_mm"] = measured.largest_deviation * kMillimetresPerMetre;
    json["reported_deviation_mm"] = result.reported_deviation * kMillimetresPerMetre;
    json["closure_mm"] = measured.closure_error * kMillimetresPerMetre;
    json["missed_cycles"] = result.missed_cycles;
    json["samples"] = result.path.positions.size();
    return json;
}

}  // namespace

std::string tableOf(const std::vector<SquareOutcome>& outcomes) {
    auto table = fmt::format("{:<14} {:>4} {:>8} {:>14} {:>12} {:>8}\n", "arm", "laps", "time/s",
                             "deviation/mm", "closure/mm", "missed");
    for (const auto& outcome : outcomes) {
        table += rowOf(outcome);
    }
    return table;
}

std::string jsonOf(const std::vector<SquareOutcome>& outcomes) {
    auto json = nlohmann::json::array();
    for (const auto& outcome : outcomes) {
        json.push_back(jsonOf(outcome));
    }
    return json.dump(2) + "\n";
}

Result<void> writePicture(const std::string& file, const std::vector<SquareOutcome>& outcomes) {
    std::vector<path_evaluation::DrawnPath> paths;
    for (const auto& outcome : outcomes) {
        if (outcome.result) {
            paths.push_back(outcome.result->path);
        }
    }
    std::error_code
        ignored;  // a folder that cannot be made shows in the file that cannot be opened
    std::filesystem::create_directories(std::filesystem::absolute(file).parent_path(), ignored);
    std::ofstream out(file);
    out << path_evaluation::drawSvg(paths);
    if (!out.flush()) {
        return fail(Errc::invalid_argument, fmt::format("{}: cannot be written", file));
    }
    return {};
}

}  // namespace metier::app
