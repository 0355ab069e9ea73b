cmake_minimum_required(VERSION 3.25)
# Writes the source file that has the page in it: the page's own files as one HTML text, with the license of three.js,
# and three.js with its controls as another text.
# usage: cmake -D WEB=src/page/web -D THREE=/usr/share/javascript/three -D COPYRIGHT=/usr/share/doc/libjs-three/copyright -D OUTPUT=FILE.cpp -P page.cmake

file(READ ${WEB}/page.html page)
file(READ ${WEB}/page.css style)
file(READ ${THREE}/three.min.js three)
file(READ ${THREE}/examples/js/controls/OrbitControls.js controls)
file(READ ${COPYRIGHT} copyright)
set(script "")
foreach(name numbers elements arrays colours charts geometry model inspector walk tables sensors main)
  file(READ ${WEB}/${name}.js part)
  string(APPEND script "${part}\n")
endforeach()

# The text of the license is at the end of Debian's file about it.
string(FIND "${copyright}" "License: Expat\n Permission" start REVERSE)
if(start EQUAL -1)
  message(FATAL_ERROR "${COPYRIGHT}: found no text of the Expat licence; expected that of three.js")
endif()
string(SUBSTRING "${copyright}" ${start} -1 licence)
string(REGEX MATCH "License: Expat\n( [^\n]*\n?)+" licence "${licence}")
string(REPLACE "License: Expat\n" "" licence "${licence}")
string(REPLACE "\n ." "\n" licence "${licence}")
string(REGEX MATCH "Copyright: [^\n]*three.js authors" holders "${copyright}")
set(licence "three.js, https://threejs.org/\n${holders}\n\n${licence}")

# Parts that hold marks of their own come last.
string(REPLACE "@STYLE@" "${style}" page "${page}")
string(REPLACE "@LICENCE@" "${licence}" page "${page}")
string(REPLACE "@SCRIPT@" "${script}" page "${page}")
set(scripts "${three}\n${controls}")

# The function `name` that returns `text`, as a raw string: a compiler reads it faster than an array of bytes.
function(write_function name text)
  string(FIND "${text}" ")PAGE\"" at)
  if(NOT at EQUAL -1)
    message(FATAL_ERROR "${name}: the text has the mark that ends a raw string; choose another in cmake/page.cmake")
  endif()
  file(APPEND ${OUTPUT} "static constexpr char ${name}_text[] = R\"PAGE(${text})PAGE\";\n"
                        "std::string_view ${name}() { return {${name}_text, sizeof ${name}_text - 1}; }\n\n")
endfunction()

file(WRITE ${OUTPUT} "#include \"page/write_page.h\"\n\nnamespace patchlight {\n\n")
write_function(page_template "${page}")
write_function(page_scripts "${scripts}")
file(APPEND ${OUTPUT} "}  // namespace patchlight\n")
