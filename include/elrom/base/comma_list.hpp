#pragma once
// Options of the programs that hold several values. Each takes exactly one word of the command line, written
// behind the option or after an equals sign, so that the word after it is the program's next argument. Left
// alone, CLI11 would take all words up to the next option, files included.
//
// Templates, so that a header of ours does not ask CLI11 of those who use the library.

namespace elrom::base {

/// `--fields a,b FILE`: values with commas between them; the option may be repeated.
template <class Option>
Option* comma_list(Option* option) {
  return option->delimiter(',')->allow_extra_args(false);
}

/// `--set a=1 --set b=2 FILE`: one value each time.
template <class Option>
Option* repeatable(Option* option) {
  return option->take_all()->allow_extra_args(false);
}

}  // namespace elrom::base
