#include "composition_files.hpp"

#include <fmt/format.h>

#include <random>
#include <utility>

#include "metier/composition/definition_file.hpp"

namespace metier::app {

Result<std::vector<composition::Definition>> loadDefinitions(
    const std::vector<std::filesystem::path>& files) {
    std::vector<composition::Definition> definitions;
    std::string problems;
    for (const auto& file : files) {
        auto definition = composition::loadDefinition(file);
        if (definition) {
            definitions.push_back(std::move(*definition));
        } else {
            problems += (problems.empty() ? "" : "\n") + definition.error().message;
        }
    }
    if (!problems.empty()) {
        return fail(Errc::invalid_argument, std::move(problems));
    }
    return composition::inOrderOfUse(std::move(definitions));
}

std::string newLife() {
    constexpr unsigned kMask = 0xFFFFFF;
    std::random_device device;
    return fmt::format("{:06x}", device() & kMask);
}

}  // namespace metier::app
