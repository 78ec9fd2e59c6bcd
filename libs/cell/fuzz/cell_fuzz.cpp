// Parses any text as a cell file, and reads each of its settings as every type that a driver may
// ask for.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "metier/cell/cell.hpp"

namespace {

using namespace metier::cell;

void ask(const Settings& settings) {
    for (const auto* name : {"a", "b", "c.d"}) {
        if (settings.has(name)) {
            static_cast<void>(settings.text(name));
            static_cast<void>(settings.flagOr(name, false));
            static_cast<void>(settings.numbersOr(name, {}, 2));
            const auto number = settings.numberOr(name, 1.0, 0.0, 2.0);
            if (!(number >= 0.0 && number <= 2.0)) {
                std::abort();
            }
        }
    }
    static_cast<void>(settings.namesUnder("c"));
    static_cast<void>(settings.finish());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto cell = parseCell(text, METIER_MODELS_DIR "/cell.toml");
    if (!cell) {
        if (cell.error().message.empty()) {
            std::abort();
        }
        return 0;
    }
    for (const auto& server : cell->servers) {
        if (const auto* driver = server.driver()) {
            ask(driver->settings);
        }
    }
    for (const auto& controller : cell->virtual_controllers) {
        ask(controller.settings);
    }
    return 0;
}
