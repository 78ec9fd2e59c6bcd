#include "kinds/composition_files.hpp"

#include <utility>

#include "metier/base/random.hpp"
#include "metier/composition/definition_file.hpp"

namespace metier::server {

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
    constexpr std::size_t kDigits = 6;
    return randomHex(kDigits);
}

}  // namespace metier::server
