#!/bin/sh
# What cannot be written is told before the long work, and left as it was.
. "$(dirname "$0")/lib.sh"
c=builtin:city
mkdir folder folder.png
echo text >file
printf x >input.png
ln -s /dev/full device.png
ln -s input.png link.png
mkfifo pipe.png

expect "a missing folder" 1 'its folder cannot be used: No such file' render $c -o missing/x.png
expect "a missing folder at the root" 1 'its folder cannot be used' render $c -o /nonexistent/x.png
expect "a file for a folder" 1 'folder' render $c -o file/x.png
expect "a folder" 1 'is a folder' render $c -o folder
expect "a folder with the right ending" 1 'is a folder' render $c -o folder.png
expect "a folder with a slash" 1 'is a folder' render $c -o folder/
expect "no ending" 2 'must end in .png or .exr' render $c -o picture
expect "another ending" 2 'must end in .png or .exr' render $c -o picture.jpg
expect "only an ending" 2 'must end in .png or .exr' render $c -o folder/.png
expect "a device" 2 'must end in' render $c -o /dev/full
expect "a device behind a link" 1 'no ordinary file' render $c -o device.png
expect "a pipe" 1 'no ordinary file' render $c -o pipe.png
expect "an input" 1 'is an input too' render input.png -o input.png
expect "an input by another name" 1 'is an input too' render input.png -o ./folder/../input.png
expect "an input behind a link" 1 'is an input too' render input.png -o link.png
expect "compare onto an input" 1 'is an input too' compare input.png file -o input.png
test "$(cat input.png)" = x && test -p pipe.png && test -L device.png && test -d folder.png && test -z "$(ls folder folder.png | grep png$)"
result $? "all is as it was"
# Root may write everywhere: then somebody else tries.
mkdir locked && chmod 555 locked && chmod 755 .
other=
[ "$(id -u)" = 0 ] && other="setpriv --reuid=65534 --regid=65534 --clear-groups"
if $other test -x "$program" && $other test -r .; then
    $other "$program" render $c -o locked/x.png >out 2>err
    test $? = 1 && grep -q 'cannot be written: Permission' err; result $? "a folder without permission"
else
    skip "a folder without permission" "no unprivileged user can run the program here"
fi
finish
