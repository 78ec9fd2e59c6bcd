#include <cstddef>
#include <cstdint>
#include <string_view>

#include "metier/virtual_controller/world_messages.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view line(reinterpret_cast<const char*>(data), size);
    (void)metier::virtual_controller::reportOf(line);
    (void)metier::virtual_controller::effectOf(line);
    return 0;
}
