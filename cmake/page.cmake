cmake_minimum_required(VERSION 3.25)
# Puts the page's own files into one HTML file, with the licence of three.js, and three.js with its controls into another.
# usage: cmake -D WEB=src/page/web -D THREE=/usr/share/javascript/three -D COPYRIGHT=/usr/share/doc/libjs-three/copyright -D PAGE=FILE -D SCRIPTS=FILE -P page.cmake

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

# The text of the licence stands at the end of Debian's file about it.
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
file(WRITE ${PAGE} "${page}")
file(WRITE ${SCRIPTS} "${three}\n${controls}")
