using System;
using System.Globalization;
using System.Text;
using Pacinian.Wire;

/// <summary>Reads lines with a JSON text and a key, both in hexadecimal; writes the key's value.</summary>
internal static class VectorsJson
{
    private static void Main()
    {
        for (string line = Console.ReadLine(); line != null; line = Console.ReadLine())
        {
            string[] parts = line.Split(' ');
            Console.WriteLine(Found(FlatJson.Parse(Text(parts[0])), Text(parts[1])));
        }
    }

    private static string Found(FlatJson json, string key)
    {
        if (json == null)
        {
            return "refused";
        }
        string text = json.Text(key, null);
        if (text != null)
        {
            return "text " + BitConverter.ToString(Encoding.UTF8.GetBytes(text)).Replace("-", "").ToLowerInvariant();
        }
        bool number = json.Number(key, 1) == json.Number(key, 2);
        return number ? "int " + json.Number(key, 0).ToString(CultureInfo.InvariantCulture) : "nothing";
    }

    private static string Text(string digits)
    {
        return Encoding.UTF8.GetString(VectorsDecoder.Bytes(digits));
    }
}
