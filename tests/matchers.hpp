// GoogleMock's matchers by their short names, for all tests of boards.
#pragma once

#include <gmock/gmock.h>

namespace lamplock::test {

using testing::AllOf;
using testing::AnyOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

}  // namespace lamplock::test
