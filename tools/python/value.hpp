// What classes of the Python module share: values, a file, a figure, a report.
#pragma once

#include <fmt/format.h>

#include "common/files.hpp"
#include "tools/program/output.hpp"
#include "tools/python/bind.hpp"
#include "tools/python/parts.hpp"

namespace ukemi::python {

/// A class of values: immutable in Python; ==, hash, copy, deepcopy and pickle go by the fields.
template <class T, class... Base>
struct Value : py::class_<T, Base...> {
  const char* const name;  ///< as in Python
  Value(py::module_& m, const char* its_name, const char* words)
      : py::class_<T, Base...>(m, its_name, words), name(its_name) {
    const auto compared = [](const T& x) { return bytes_of(x, Writer::Purpose::kCompare); };
    this->def(
            "__eq__", [compared](const T& a, const T& b) { return &a == &b || compared(a) == compared(b); },
            py::is_operator())
        .def("__hash__", [compared](const T& x) { return py::hash(py::bytes(compared(x))); })
        .def("__copy__", [](const T& x) { return T(x); })
        .def(
            "__deepcopy__", [](const T& x, const py::dict&) { return T(x); }, py::arg("memo"))
        .def(py::pickle(
            [](const T& x) { return py::make_tuple(UKEMI_VERSION, py::bytes(bytes_of(x, Writer::Purpose::kPickle))); },
            [](const py::tuple& state) {
              if (state.size() != 2 || py::str(state[0]).cast<std::string>() != UKEMI_VERSION)
                throw InputError("pickle: it is of another version than " UKEMI_VERSION);
              return value_of_bytes<T>(state[1].cast<std::string>());
            }));
  }
  /// Binds repr: what text(x) says after the class's name.
  template <class Text>
  void repr(Text text) {
    this->def("__repr__", [text, name = name](const T& x) { return fmt::format("<ukemi.{}{}>", name, text(x)); });
  }
};
/// A result and the seed of its search.
template <class T>
struct Seeded {
  T result;
  std::uint64_t seed = 1;
};

/// Binds toml() and save(path); `what`: "a scene file".
template <class T, class Text, class... Options>
void bind_file(py::class_<T, Options...>& c, const std::string& what, Text text) {
  c.def("toml", text, ("The text of " + what + ".").c_str())
      .def(
          "save", [text](const T& x, const Path& path) { write_file(path, text(x)); }, py::arg("path"),
          ("Writes " + what + ".").c_str());
}

/// Binds figure(), which notebooks show.
template <class T, class Draw, class... Options>
void bind_figure(py::class_<T, Options...>& c, Draw draw, const char* words) {
  c.def("figure", draw, words)
      .def(
          "_repr_svg_", [draw](const T& x) { return draw(x).svg; }, "What a notebook shows.");
}

/// summary.json of a folder as a dict.
py::dict summary_of(const std::string& folder);
/// Options of a silent run that writes into `folder`. `formats` of figures: svg, pdf, png.
tools::CommonOptions report_options(const Path& folder, const std::vector<std::string>& formats, std::uint64_t seed);

/// Writes a verb's files; report(result, run): the program's own report. Returns the summary.
template <class T, class Write>
py::dict written(const T& result, const tools::Outputs& outputs, const Path& folder,
                 const std::vector<std::string>& figures, std::uint64_t seed, const Write& report) {
  {
    const py::gil_scoped_release release;
    tools::Run run(outputs, report_options(folder, figures, seed));
    (void)report(result, run);
  }
  return summary_of(folder);
}
inline std::string report_words(const std::string& verb) {
  return "Writes what `ukemi " + verb +
         "` would into a folder: report.html, summary.json, its other files; figures: formats of files of their own, "
         "of svg, pdf, png. Returns the summary.";
}
/// Of a result without random numbers.
inline constexpr auto kNoSeed = [](auto&) { return std::uint64_t(1); };
/// Binds write_report(folder, figures), which writes the files of the program's verb. `seed`: a function or a member.
template <class T, class Seed, class Write, class... Options>
void bind_report(py::class_<T, Options...>& c, const tools::Outputs& outputs, Seed seed, Write report) {
  c.def(
      "write_report",
      [=, &outputs](const T& result, const Path& folder, const std::vector<std::string>& figures) {
        return written(result, outputs, folder, figures, std::invoke(seed, result), report);
      },
      py::arg("folder"), py::arg("figures") = std::vector<std::string>{}, report_words(outputs.verb).c_str());
}

/// The same of a result with its seed, of which report(result, run) is the report.
template <class T, class... Options>
void bind_report(py::class_<Seeded<T>, Options...>& c, const tools::Outputs& outputs) {
  bind_report(c, outputs, &Seeded<T>::seed, [](auto& x, tools::Run& run) { return report(x.result, run); });
}

}  // namespace ukemi::python
