#include "metier/client/lack.hpp"

#include <fmt/format.h>

namespace metier::client {
namespace {

std::string_view consequenceOf(Lack lack) noexcept {
    switch (lack) {
        case Lack::atomic_start:
            return "another client may write between its parameters and Start";
        case Lack::dead_man:
            return "it goes on if its client dies";
        case Lack::measured_state:
            return "the measured position is as old as its server leaves it";
        case Lack::safety_state:
            return "a stop of the robot shows only as the end of its stream";
    }
    return "";
}

}  // namespace

std::string_view toString(Lack lack) noexcept {
    switch (lack) {
        case Lack::atomic_start:
            return "atomic start";
        case Lack::dead_man:
            return "dead-man";
        case Lack::measured_state:
            return "measured state at the arm's rate";
        case Lack::safety_state:
            return "safety state";
    }
    return "";
}

std::string textOf(const std::vector<Lack>& lacks) {
    std::string text;
    for (const auto lack : lacks) {
        text += fmt::format("{}no {}", text.empty() ? "" : ", ", toString(lack));
    }
    return text;
}

std::string explanationOf(const std::vector<Lack>& lacks) {
    std::string text;
    for (const auto lack : lacks) {
        text += fmt::format("{}no {} ({})", text.empty() ? "" : ", ", toString(lack),
                            consequenceOf(lack));
    }
    return text;
}

}  // namespace metier::client
