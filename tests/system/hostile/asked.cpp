#include "asked.hpp"

#include <algorithm>

namespace metier::hostile {

namespace {

constexpr std::uint32_t kMostItems = 2'000;

/// Bytes before the array of a request whose elements are counted.
std::size_t bytesBeforeItems(std::uint32_t type, Reader& reader) {
    switch (type) {
        case 527:  // Browse: view, and how many references at most
            reader.id();
            return 8 + 4 + 4;
        case 533:  // BrowseNext
            return 1;
        case 631:  // Read
            return 8 + 4;
        case 751:  // CreateMonitoredItems
            return 4 + 4;
        case 781:  // DeleteMonitoredItems
            return 4;
        default:
            return 0;
    }
}

}  // namespace

Asked readRequest(Reader reader) {
    Asked asked;
    asked.type = reader.standardId();
    reader.id();
    reader.number<std::uint64_t>();
    asked.handle = reader.number<std::uint32_t>();
    reader.number<std::uint32_t>();
    reader.text();
    reader.number<std::uint32_t>();
    reader.skipExtension();
    reader.raw(bytesBeforeItems(asked.type, reader));
    asked.items = std::min(reader.number<std::uint32_t>(), kMostItems);
    return asked;
}

}  // namespace metier::hostile
