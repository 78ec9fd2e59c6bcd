// Replaces operator new; apart from the tests, so that no compiler pairs its halves across calls.
// NOLINTBEGIN(cppcoreguidelines-no-malloc): these are operator new and operator delete

#include "metier/base/testing/allocation_count.hpp"

#include <cstdlib>
#include <new>

namespace {
// Count of one thread, so that the other threads of a test do not count.
thread_local std::size_t allocations = 0;
}  // namespace

void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size)) {
        return memory;
    }
    throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    ++allocations;
    const auto align = static_cast<std::size_t>(alignment);
    if (void* memory = std::aligned_alloc(align, (size + align - 1) / align * align)) {
        return memory;
    }
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
// NOLINTEND(cppcoreguidelines-no-malloc)

namespace metier {

std::size_t allocationCount() noexcept {
    return allocations;
}

}  // namespace metier
