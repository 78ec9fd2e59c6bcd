// Fuzzes a file of users: an accepted one is written and read again unchanged.
#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "metier/security/users.hpp"
#include "scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using metier::security::UserTable;
    static const metier::fuzz::Scratch own_file("users_fuzz");
    const auto& file = own_file.path();
    std::ofstream(file, std::ios::binary | std::ios::trunc)
        << std::string_view(reinterpret_cast<const char*>(data), size);
    ::chmod(file.c_str(), S_IRUSR | S_IWUSR);
    const auto table = UserTable::load(file);
    if (!table) {
        return table.error().message.empty() ? (std::abort(), 0) : 0;
    }
    if (!table->save(file)) {
        std::abort();
    }
    const auto again = UserTable::load(file);
    if (!again || again->users().size() != table->users().size()) {
        std::abort();
    }
    for (const auto& user : table->users()) {
        const auto* same = again->find(user.name);
        if (same == nullptr || same->role != user.role ||
            same->password_hash != user.password_hash) {
            std::abort();
        }
    }
    return 0;
}
