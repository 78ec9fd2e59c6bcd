// Text of a composition file; what is taken is ordered and drawn.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "metier/composition/definition_file.hpp"
#include "metier/composition/dot.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::composition;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto definition = parseDefinition(text, "Input");
    if (!definition) {
        return definition.error().message.empty() ? (std::abort(), 0) : 0;
    }
    static_cast<void>(toDot(*definition));
    const auto ordered = inOrderOfUse({*definition});
    if (!ordered && ordered.error().message.empty()) {
        std::abort();
    }
    return 0;
}
