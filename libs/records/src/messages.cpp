#include "messages.hpp"

#include <string>
#include <type_traits>

#include "metier/records/members.hpp"

namespace metier::records {
namespace {

template <typename Record>
std::size_t sizeOf(const Record& record) {
    std::size_t bytes = 0;
    visitMembers(record, [&bytes](const Member& /*member*/, const auto& value) {
        if constexpr (std::is_same_v<decltype(value), const std::string&>) {
            bytes += value.capacity();
        }
    });
    return bytes;
}

std::size_t sizeOf(const std::unique_ptr<ExecutionRow>& execution) {
    return sizeof *execution + sizeOf(*execution);
}

}  // namespace

std::size_t sizeOf(const Message& message) {
    return sizeof message +
           std::visit([](const auto& content) { return sizeOf(content); }, message.content);
}

}  // namespace metier::records
