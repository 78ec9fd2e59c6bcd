#include "metier/server/ready_line.hpp"

#include <gtest/gtest.h>

namespace metier::server {
namespace {

TEST(ReadyLine, IsReadBackAsItsAddress) {
    EXPECT_EQ(addressOfReadyLine(readyLine("opc.tcp://127.0.0.1:4841")),
              "opc.tcp://127.0.0.1:4841");
    EXPECT_EQ(addressOfReadyLine(readyVirtualLine("127.0.1.2")), "127.0.1.2");
}

TEST(ReadyLine, IsNoOtherLine) {
    for (const auto* line : {"", "ready", "ready ", "ready http://127.0.0.1:8080",
                             "metier: the port is taken", "already opc.tcp://127.0.0.1:4841"}) {
        EXPECT_EQ(addressOfReadyLine(line), std::nullopt) << line;
    }
}

}  // namespace
}  // namespace metier::server
