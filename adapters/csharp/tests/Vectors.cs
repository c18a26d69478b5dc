using System;
using System.IO;

/// <summary>
/// Reads lines of socket, bytes in hexadecimal, "valid" or "refused", and the bytes that it means or the path of what is
/// wrong, parted by tabs; the same as Python finds must be found here. Writes what differs; 1 if anything does.
/// </summary>
internal static class Vectors
{
    private static int Main(string[] arguments)
    {
        string[] lines = File.ReadAllLines(arguments[0]);
        VectorsDecoder old = new VectorsDecoder();
        int wrong = 0;
        foreach (string line in lines)
        {
            string[] parts = line.Split('\t');
            byte[] data = VectorsDecoder.Bytes(parts[1]);
            string expected = parts[2] + " " + parts[3];
            string fresh = new VectorsDecoder().Decode(parts[0], data), again = old.Decode(parts[0], data);
            if (fresh != expected || again != expected)
            {
                wrong++;
                Console.WriteLine(line + "\n    fresh: " + fresh + "\n    again: " + again);
            }
        }
        Console.WriteLine(lines.Length + " messages, " + wrong + " differ");
        return wrong == 0 ? 0 : 1;
    }
}
