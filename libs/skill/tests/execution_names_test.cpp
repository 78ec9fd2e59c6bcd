#include "metier/skill/execution_names.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <string>

#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using ::testing::HasSubstr;

/// A file of the test's own, which is removed after it.
class KeptNames : public ::testing::Test {
protected:
    KeptNames() { std::filesystem::remove_all(folder_); }
    ~KeptNames() override { std::filesystem::remove_all(folder_); }
    KeptNames(const KeptNames&) = delete;
    KeptNames& operator=(const KeptNames&) = delete;

    std::unique_ptr<ExecutionNames> open(std::size_t least = ExecutionNames::kLeast) const {
        auto names = ExecutionNames::open(file_, least);
        EXPECT_TRUE(names) << names.error().message;
        return std::move(names.value());
    }

    /// Notes a name and waits until it is in the file; it is forgotten if it is not.
    static Result<void> keep(ExecutionNames& names, std::string_view skill, std::string_view name) {
        const auto kept = std::make_shared<std::promise<Result<void>>>();
        auto outcome = kept->get_future();
        const auto noted = names.note(
            skill, name, [kept](Result<void> result) { kept->set_value(std::move(result)); });
        auto result = noted ? outcome.get() : metier::fail(noted.error());
        if (!result) {
            names.forget(skill, name);
        }
        return result;
    }

    const std::filesystem::path folder_ =
        std::filesystem::path(::testing::TempDir()) /
        (std::string("names_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    const std::filesystem::path file_ = folder_ / "of" / "server.executions";
};

TEST_F(KeptNames, OutliveTheServerThatNotedThem) {
    ASSERT_TRUE(keep(*open(), "Weld", "order 66"));
    const auto names = open();
    EXPECT_TRUE(names->knows("Weld", "order 66"));
    EXPECT_FALSE(names->knows("Weld", "order 67"));
    EXPECT_FALSE(names->knows("Grasp", "order 66")) << "each skill has names of its own";
}

TEST_F(KeptNames, MayHoldAnyCharacter) {
    const std::string strange = std::string("a\nb\tc%0ad\\") + '\0' + "ß";
    ASSERT_TRUE(keep(*open(), "Weld", strange));
    const auto names = open();
    EXPECT_TRUE(names->knows("Weld", strange));
    EXPECT_FALSE(names->knows("Weld", "b"));
    EXPECT_FALSE(names->knows("Weld", "a"));
}

TEST_F(KeptNames, AreWrittenWholeAfterALineThatACrashHasCutOff) {
    ASSERT_TRUE(keep(*open(), "Weld", "whole"));
    std::ofstream(file_, std::ios::app) << "Weld\tcut o";
    ASSERT_TRUE(keep(*open(), "Weld", "next"));
    const auto names = open();
    EXPECT_TRUE(names->knows("Weld", "whole"));
    EXPECT_TRUE(names->knows("Weld", "next"));
    EXPECT_FALSE(names->knows("Weld", "cut o")) << "its execution has not begun";
}

/// No file of this process grows beyond that size, until the end of the block.
class FullDisk {
public:
    explicit FullDisk(std::uintmax_t size) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{size, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;

private:
    rlimit before_{};
    void (*handler_)(int) = std::signal(SIGXFSZ, SIG_IGN);
};

TEST_F(KeptNames, AreWrittenWholeAfterALineForWhichTheDiskHadNoRoom) {
    {
        const auto names = open();
        ASSERT_TRUE(keep(*names, "Weld", "whole"));
        Result<void> refused;
        {
            const FullDisk disk(std::filesystem::file_size(file_) + 8);
            refused = keep(*names, "Weld", "too long for what is left");
        }
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
        EXPECT_THAT(refused.error().message, HasSubstr("cannot note a start"));
        EXPECT_FALSE(names->knows("Weld", "too long for what is left"));
        ASSERT_TRUE(keep(*names, "Weld", "next"));
    }
    const auto names = open();
    EXPECT_TRUE(names->knows("Weld", "whole"));
    EXPECT_TRUE(names->knows("Weld", "next"));
    EXPECT_FALSE(names->knows("Weld", "too long for what is left")) << "it has not begun";
}

TEST_F(KeptNames, BelongToOneServer) {
    const auto mine = open();
    const auto second = ExecutionNames::open(file_);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::resource_unavailable);
    EXPECT_THAT(second.error().message, HasSubstr(file_.string()));
}

TEST_F(KeptNames, ThatCannotBeWrittenAreAnError) {
    const auto refused = ExecutionNames::open("/proc/none/of.executions");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
}

TEST_F(KeptNames, AreAtLeastTheLatestAndNotAll) {
    constexpr int least = 10;
    auto names = open(least);
    for (int i = 1; i <= 35; ++i) {
        ASSERT_TRUE(keep(*names, "Weld", std::to_string(i)));
        for (int earlier = std::max(1, i - least + 1); earlier <= i; ++earlier) {
            ASSERT_TRUE(names->knows("Weld", std::to_string(earlier))) << earlier << " of " << i;
        }
    }
    EXPECT_FALSE(names->knows("Weld", "1"));
    names.reset();
    names = open(least);
    EXPECT_TRUE(names->knows("Weld", "35"));
    EXPECT_TRUE(names->knows("Weld", "26"));
    EXPECT_FALSE(names->knows("Weld", "1"));
}

/// Starts and finishes an execution.
void finishOne(ProgramBench& bench, const std::string& id) {
    ASSERT_TRUE(bench.program->startWith(kAlice, {.execution_id = id}));
    bench.script->execution.finish();
    bench.run();
}

TEST(NamedExecution, NeverStartsAgainOnceItsRecordIsForgotten) {
    ProgramBench bench;
    finishOne(bench, "first");
    for (std::size_t i = 0; i < ExecutionHistory::kMost; ++i) {
        finishOne(bench, {});
    }
    bench.forget();
    const auto again = bench.program->startWith(kAlice, {.execution_id = "first"});
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().code, Errc::already_exists);
    EXPECT_THAT(again.error().message, HasSubstr("\"first\" has begun once"));
    EXPECT_THAT(bench.program->execution("first").error().message, HasSubstr("has begun once"));
    EXPECT_TRUE(bench.observer.transitions().empty());
}

TEST_F(KeptNames, NeverStartAgainInAServerThatIsStartedAgain) {
    {
        ProgramBench bench({.names = open()});
        ASSERT_TRUE(bench.program->startWith(kAlice, {.execution_id = "first"}));
    }
    ProgramBench bench({.names = open()});
    const auto again = bench.program->startWith(kAlice, {.execution_id = "first"});
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().code, Errc::already_exists);
    EXPECT_TRUE(bench.observer.transitions().empty());
    EXPECT_TRUE(bench.program->startWith(kAlice, {.execution_id = "second"}));
}

TEST_F(KeptNames, OfARefusedStartMayBeUsedAgain) {
    ProgramBench bench({.names = open()});
    EXPECT_FALSE(bench.program->startWith(
        kAlice, {.execution_id = "first", .parameters = {{"Speed", 99.0}}}));
    EXPECT_TRUE(bench.program->startWith(kAlice, {.execution_id = "first"}));
}

TEST_F(KeptNames, OfAFileThatCannotBeMendedAreAnError) {
    const auto refused = ExecutionNames::open("/dev/null");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
    EXPECT_THAT(refused.error().message, HasSubstr("/dev/null: cannot mend it"));
}

TEST_F(KeptNames, DoNotTakeTheEscapeOfACharacterForTheCharacter) {
    ASSERT_TRUE(keep(*open(), "Weld", "100%0a"));
    const auto names = open();
    EXPECT_TRUE(names->knows("Weld", "100%0a"));
    EXPECT_FALSE(names->knows("Weld", "100\n"));
}

TEST_F(KeptNames, AreRefusedWhileTheFileCannotBeginAnewAndTakenOnceItCan) {
    const auto names = open(1);
    ASSERT_TRUE(keep(*names, "Weld", "1"));
    const auto in_the_way = file_.string() + ".old";
    std::filesystem::create_directories(in_the_way + "/folder");
    const auto refused = keep(*names, "Weld", "2");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
    EXPECT_THAT(refused.error().message, HasSubstr("cannot begin it anew"));
    EXPECT_FALSE(names->knows("Weld", "2"));
    std::filesystem::remove_all(in_the_way);
    ASSERT_TRUE(keep(*names, "Weld", "3"));
    EXPECT_TRUE(std::filesystem::is_regular_file(in_the_way)) << "the file has begun anew";
}

TEST_F(KeptNames, BeginAnewAlsoIfSomebodyHasRemovedTheFile) {
    const auto names = open(1);
    ASSERT_TRUE(keep(*names, "Weld", "1"));
    std::filesystem::remove(file_);
    EXPECT_TRUE(keep(*names, "Weld", "2"));
    EXPECT_TRUE(std::filesystem::exists(file_));
}

TEST_F(KeptNames, ThatWaitWhenTheServerEndsAreStillWritten) {
    constexpr int count = 50;
    {
        const auto names = open();
        for (int i = 0; i < count; ++i) {
            ASSERT_TRUE(names->note("Weld", std::to_string(i),
                                    [](const Result<void>& kept) { EXPECT_TRUE(kept); }));
        }
    }
    const auto names = open();
    for (int i = 0; i < count; ++i) {
        EXPECT_TRUE(names->knows("Weld", std::to_string(i))) << i;
    }
}

TEST(NamesInMemory, ThatAreForgottenMayBeUsedAgainAlsoOnceOthersCameAfterThem) {
    ExecutionNames names(1);
    ASSERT_TRUE(names.note("Weld", "old", {}));
    ASSERT_TRUE(names.note("Weld", "new", {}));
    ASSERT_TRUE(names.knows("Weld", "old"));
    names.forget("Weld", "old");
    names.forget("Weld", "new");
    EXPECT_FALSE(names.knows("Weld", "old"));
    EXPECT_FALSE(names.knows("Weld", "new"));
}

}  // namespace
}  // namespace metier::skill::testing
