// Runs a fuzz target without a fuzzer: the files named on the command line, then random inputs
// that are random bytes, or one of the files with some bytes changed. The seed is fixed.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr int kInputs = 5'000;
constexpr std::size_t kLongest = 512;

using Bytes = std::vector<std::uint8_t>;

Bytes randomInput(std::mt19937& random, const std::vector<Bytes>& seeds) {
    const auto below = [&](std::size_t limit) { return random() % limit; };
    Bytes input;
    if (!seeds.empty() && below(4) != 0) {
        input = seeds[below(seeds.size())];
        for (auto changes = below(8); changes > 0 && !input.empty(); --changes) {
            input[below(input.size())] = static_cast<std::uint8_t>(random());
        }
        input.resize(below(2) == 0 ? input.size() : below(input.size() + 1));
        return input;
    }
    input.resize(below(kLongest));
    for (auto& byte : input) {
        byte = static_cast<std::uint8_t>(random());
    }
    return input;
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<Bytes> seeds;
    for (int i = 1; i < argc; ++i) {
        std::ifstream file(argv[i], std::ios::binary);
        seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
        LLVMFuzzerTestOneInput(seeds.back().data(), seeds.back().size());
    }
    std::mt19937 random(2026);
    for (int i = 0; i < kInputs; ++i) {
        const auto input = randomInput(random, seeds);
        LLVMFuzzerTestOneInput(input.data(), input.size());
    }
    return EXIT_SUCCESS;
}
