// Fuzzes a log: a file with any content is read, continued, and read again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "metier/security/audit_log.hpp"
#include "scratch.hpp"

namespace {

using namespace metier::security;
namespace fs = std::filesystem;

/// Takes another entry, if the file is a log.
bool goOn(const fs::path& file) {
    auto log = AuditLog::open({file, {}});
    if (!log) {
        return log.error().message.empty() ? (std::abort(), false) : false;
    }
    (*log)->append({metier::UtcTime(), "Start", {{"user", "somebody"}}});
    return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const metier::fuzz::Scratch own_file("audit_log_fuzz");
    const auto& file = own_file.path();
    std::ofstream(file, std::ios::binary | std::ios::trunc)
        << std::string_view(reinterpret_cast<const char*>(data), size);
    const auto before = verify(file);
    const bool taken = goOn(file);
    const auto after = verify(file);
    // One that was whole stays so, with an entry more.
    if (before && (!taken || !after || after->entries != before->entries + 1)) {
        std::abort();
    }
    if ((!before && before.error().message.empty()) || (!after && after.error().message.empty())) {
        std::abort();
    }
    return 0;
}
